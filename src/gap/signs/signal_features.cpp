#include "gap/signs/signal_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "gap/signs/chance.hpp"
#include "numeric/index.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

using Column = std::vector<double>;

/// The record's signals in units of their scales.
struct ScaledSignals {
  Column y;
  Column u;
};

ScaledSignals scaled(const Leftover& r, const SignalScales& s) {
  ScaledSignals out;
  for (std::size_t i = 0; i < r.output.size(); ++i) {
    out.y.push_back((r.output[i] - s.middle_y) / s.size_y);
    out.u.push_back((r.input[i] - s.middle_u) / s.size_u);
  }
  return out;
}

/// Any static curve: cosines of so many halves of a period over its range.
void add_curves(const Column& v, std::vector<Column>& columns) {
  for (std::size_t halves = 1; halves <= kNeighbours; ++halves) {
    Column& c = columns.emplace_back(v);
    for (double& x : c) x = std::cos(0.5 * std::numbers::pi * static_cast<double>(halves) * (x + 1.0));
  }
}

void add_earlier(const Column& x, std::size_t lag, std::vector<Column>& columns) {
  Column& c = columns.emplace_back(x);
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = x[i > lag ? i - lag : 0];
}

/// Of the output: itself, its change, curves of it, and earlier ones (what linear dynamics of any kind and an echo leave is a sum of these).
std::vector<Column> output_features(const Column& y, std::size_t apart) {
  std::vector<Column> columns(4);
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double v = i > 0 ? y[i] - y[i - 1] : 0.0;
    const std::array now = {y[i], v, std::abs(v), y[i] * v};
    for (std::size_t k = 0; k < now.size(); ++k) columns[k].push_back(now[k]);
  }
  add_curves(y, columns);
  for (std::size_t k = 1; k <= kNeighbours; ++k) add_earlier(y, k * apart, columns);
  return columns;
}

/// Of the input: itself, curves of it, its branch (1 while it rises, -1 while it falls), earlier ones, plays and slow averages.
std::vector<Column> input_features(const Column& u) {
  const std::size_t n = u.size();
  std::vector<Column> columns(4);
  double branch = 1.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0 && u[i] != u[i - 1]) branch = u[i] > u[i - 1] ? 1.0 : -1.0;
    const std::array now = {u[i], branch, branch * u[i], branch * u[i] * u[i]};
    for (std::size_t k = 0; k < now.size(); ++k) columns[k].push_back(now[k]);
  }
  add_curves(u, columns);
  for (std::size_t lag : {1U, 2U, 4U}) add_earlier(u, lag, columns);
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
  return columns;
}

/// What columns become through the model's linear dynamics, which rest where each begins.
void pass_through(const chain::Chain& dynamics, double step_s, std::vector<Column>& columns) {
  if (dynamics.blocks.empty()) return;
  simulate::RecordSimulator simulator(dynamics, step_s);
  for (Column& c : columns) {
    const double first = c.front();
    for (double& v : c) v -= first;
    std::ranges::copy(simulator.run(c), c.begin());
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
  }
  const auto apart = std::clamp(eighth, 1.0, static_cast<double>(records.front().output.size()));
  return {y.middle(), y.half(), u.middle(), u.half(), static_cast<std::size_t>(apart)};
}

Eigen::MatrixXd signal_features(const Leftover& record, const SignalScales& scales) {
  const auto signals = scaled(record, scales);
  auto columns = output_features(signals.y, scales.eighth_of_period);
  auto of_input = input_features(signals.u);
  pass_through(record.dynamics, record.step_s, of_input);
  std::ranges::move(of_input, std::back_inserter(columns));
  return of_zero_mean(columns);
}

}  // namespace bodesmith::gap
