#include "lti/time_response.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "lti/state_space.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

/// x and the constant input after `step` seconds, of [x; u]' = [A b; 0 0][x; u].
Eigen::MatrixXd propagator(const StateSpace& system, double step) {
  const auto n = static_cast<Eigen::Index>(system.order());
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) m(i, j) = step * system.a[static_cast<std::size_t>(i * n + j)];
    m(i, n) = step * system.b[static_cast<std::size_t>(i)];
  }
  return matrix_exponential(m);
}

double crossing_time(const TimeResponse& r, double level, double final_value) {
  for (std::size_t i = 1; i < r.step.size(); ++i) {
    const double a = r.step[i - 1] / final_value;
    const double b = r.step[i] / final_value;
    if (a < level && b >= level)
      return r.time_s[i - 1] + (level - a) / (b - a) * (r.time_s[i] - r.time_s[i - 1]);
  }
  return 0.0;
}

std::optional<TimeResponse::Figures> figures_of(const TimeResponse& r, double final_value) {
  if (!std::isfinite(final_value) || final_value == 0.0) return std::nullopt;
  constexpr double kBand = 0.02;
  if (std::abs(r.step.back() / final_value - 1.0) > kBand) return std::nullopt;
  TimeResponse::Figures out;
  out.final_value = final_value;
  out.rise_s = std::max(0.0, crossing_time(r, 0.9, final_value) - crossing_time(r, 0.1, final_value));
  double most = 1.0;
  for (std::size_t i = 0; i < r.step.size(); ++i) {
    const double value = r.step[i] / final_value;
    most = std::max(most, value);
    if (std::abs(value - 1.0) > kBand) out.settling_s = i + 1 < r.step.size() ? r.time_s[i + 1] : r.time_s[i];
  }
  out.overshoot_percent = 100.0 * (most - 1.0);
  return out;
}

}  // namespace

double response_duration_s(const Sections& sections) {
  double slowest = 0.0;
  for (const Section& section : sections.sections) {
    for (const Complex& p : section.poles) {
      const double rate = p.real() != 0.0 ? std::abs(p.real()) : std::abs(p) / 10.0;
      if (rate > 0.0) slowest = std::max(slowest, 1.0 / rate);
    }
  }
  return sections.delay_s + (slowest > 0.0 ? 7.0 * slowest : 1.0);
}

TimeResponse time_response(const Sections& sections, double duration_s, int count) {
  if (!(duration_s > 0.0) || count < 2)
    throw InputError("a time response needs a duration above 0 and at least two samples");
  const StateSpace system = state_space(sections);
  const auto n = static_cast<Eigen::Index>(system.order());
  const double step = duration_s / (count - 1);
  const Eigen::MatrixXd one_step = propagator(system, step);
  // [x; 1] of the step, and of the impulse: x(0+) = b without input.
  Eigen::VectorXd after_step = Eigen::VectorXd::Zero(n + 1);
  after_step(n) = 1.0;
  Eigen::VectorXd after_impulse = Eigen::VectorXd::Zero(n + 1);
  for (Eigen::Index i = 0; i < n; ++i) after_impulse(i) = system.b[static_cast<std::size_t>(i)];
  const Eigen::Map<const Eigen::VectorXd> c(system.c.data(), n);
  TimeResponse out;
  out.direct = system.d;
  bool begun = false;
  for (int k = 0; k < count; ++k) {
    const double t = step * k;
    out.time_s.push_back(t);
    if (t < sections.delay_s) {
      out.step.push_back(0.0);
      out.impulse.push_back(0.0);
      continue;
    }
    if (!begun) {
      const Eigen::MatrixXd first = propagator(system, t - sections.delay_s);
      after_step = first * after_step;
      after_impulse = first * after_impulse;
      begun = true;
    }
    out.step.push_back(c.dot(after_step.head(n)) + system.d);
    out.impulse.push_back(c.dot(after_impulse.head(n)));
    after_step = one_step * after_step;
    after_impulse = one_step * after_impulse;
  }
  out.figures = figures_of(out, sections.dc_gain());
  return out;
}

}  // namespace bodesmith
