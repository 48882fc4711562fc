#include "gap/signs/signal_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "numeric/index.hpp"

namespace bodesmith::gap {
namespace {

using Column = std::vector<double>;

/// The record's signals in units of their scales.
struct ScaledSignals {
  Column y;
  Column v;  ///< slope of y
  Column u;
  Column branch;  ///< 1 while the input rises, -1 while it falls
};

ScaledSignals scaled(const Leftover& r, const SignalScales& s) {
  const std::size_t n = r.output.size();
  ScaledSignals out{Column(n), Column(n), Column(n), Column(n)};
  double sign = 1.0;
  for (std::size_t i = 0; i < n; ++i) {
    out.y[i] = (r.output[i] - s.middle_y) / s.size_y;
    out.u[i] = (r.input[i] - s.middle_u) / s.size_u;
    out.v[i] = i > 0 ? (r.output[i] - r.output[i - 1]) / r.step_s / s.size_v : 0.0;
    const double du = i > 0 ? r.input[i] - r.input[i - 1] : 0.0;
    if (du != 0.0) sign = du > 0.0 ? 1.0 : -1.0;
    out.branch[i] = sign;
  }
  return out;
}

double sign_of(double v) {
  return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0;
}

/// Features of the present sample.
std::vector<Column> memoryless_features(const ScaledSignals& s) {
  constexpr double kEnd = 0.6;  // where the ends of the output's range begin
  std::vector<Column> columns;
  const auto add = [&](auto feature) {
    Column& c = columns.emplace_back(s.y.size());
    for (std::size_t i = 0; i < c.size(); ++i) c[i] = feature(s.y[i], s.v[i], s.u[i], s.branch[i]);
  };
  add([](double y, double, double, double) { return y; });
  add([](double y, double, double, double) { return y * y; });
  add([](double y, double, double, double) { return y * y * y; });
  add([](double y, double, double, double) { return std::abs(y); });
  add([](double, double v, double, double) { return v; });
  add([](double, double v, double, double) { return std::abs(v); });
  add([](double, double v, double, double) { return std::abs(v) * v; });
  add([](double, double v, double, double) { return v * v; });
  add([](double y, double v, double, double) { return y * v; });
  add([](double y, double v, double, double) { return y * y * v; });
  add([](double y, double v, double, double) { return y * std::abs(v); });
  add([](double, double v, double, double) { return sign_of(v); });
  add([](double y, double v, double, double) { return sign_of(v) * y; });
  add([](double y, double v, double, double) { return sign_of(v) * (y * y); });
  add([](double, double, double, double branch) { return branch; });
  add([](double, double, double u, double branch) { return branch * u; });
  add([](double, double, double u, double branch) { return branch * (u * u); });
  add([](double y, double, double, double) { return std::max(y - kEnd, 0.0); });
  add([](double y, double, double, double) { return std::max(-y - kEnd, 0.0); });
  add([](double, double, double u, double) { return u; });
  add([](double, double, double u, double) { return u * u; });
  return columns;
}

/// Earlier outputs that are kept: two of their periods and more.
constexpr std::size_t kEarlierOutputs = 16;

/// Features that remember: earlier inputs, plays and slow averages of them, earlier outputs (what linear dynamics of any kind and an echo
/// leave is a sum of these).
void add_memory_features(const ScaledSignals& s, std::size_t apart, std::vector<Column>& columns) {
  const Column& u = s.u;
  const std::size_t n = u.size();
  const auto add_earlier = [&](const Column& x, std::size_t lag) {
    Column& c = columns.emplace_back(n);
    for (std::size_t i = 0; i < n; ++i) c[i] = x[i > lag ? i - lag : 0];
  };
  for (std::size_t lag : {1U, 2U, 4U}) add_earlier(u, lag);
  for (std::size_t k = 1; k <= kEarlierOutputs; ++k) add_earlier(s.y, k * apart);
  for (double radius : {0.05, 0.2, 0.5}) {
    Column play(n);
    double z = 0.0;
    for (std::size_t i = 0; i < n; ++i) play[i] = z = std::clamp(z, u[i] - radius, u[i] + radius);
    Column size(n);
    for (std::size_t i = 0; i < n; ++i) size[i] = std::abs(play[i]);
    columns.push_back(std::move(play));
    columns.push_back(std::move(size));
  }
  for (double samples : {30.0, 200.0}) {
    Column& c = columns.emplace_back(n);
    double z = 0.0;
    for (std::size_t i = 0; i < n; ++i) c[i] = z += (u[i] - z) / samples;
  }
}

Eigen::MatrixXd of_zero_mean(const std::vector<Column>& columns) {
  Eigen::MatrixXd x(eigen_index(columns.front().size()), eigen_index(columns.size()));
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    const auto column = as_eigen(columns[std_index(k)]);
    x.col(k) = column.array() - column.mean();
  }
  return x;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void widen(const std::vector<double>& v) {
    for (double x : v) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
  double middle() const { return 0.5 * (low + high); }
  double half() const { return std::max(0.5 * (high - low), 1e-300); }
};

}  // namespace

SignalScales signal_scales(const std::vector<Leftover>& records) {
  Range y;
  Range u;
  double speed = 0.0;
  double eighth = std::numeric_limits<double>::infinity();
  for (const auto& r : records) {
    y.widen(r.output);
    u.widen(r.input);
    const auto out = as_eigen(r.output);
    const Eigen::Index later = std::max<Eigen::Index>(out.size() - 1, 0);
    // Of a sine the rms over that of its changes from sample to sample is its period over 2π.
    const Eigen::VectorXd changes = out.tail(later) - out.head(later);
    eighth = std::min(eighth, 0.25 * std::numbers::pi * (out.array() - out.mean()).matrix().norm() /
                                  std::max(changes.norm(), 1e-300));
    speed = std::max(speed, changes.lpNorm<Eigen::Infinity>() / r.step_s);
  }
  const auto apart = std::clamp(eighth, 1.0, static_cast<double>(records.front().output.size()));
  return {y.middle(), y.half(), std::max(speed, 1e-300),
          u.middle(), u.half(), static_cast<std::size_t>(apart)};
}

Eigen::MatrixXd signal_features(const Leftover& record, const SignalScales& scales) {
  const auto signals = scaled(record, scales);
  auto columns = memoryless_features(signals);
  add_memory_features(signals, scales.eighth_of_period, columns);
  return of_zero_mean(columns);
}

}  // namespace bodesmith::gap
