#include "lti/time_response.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "lti/state_space.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/root.hpp"

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

/// Figures of the step that do not depend on which times were asked for: on a grid of their own, and exact between its times.
std::optional<TimeResponse::Figures> figures_of(const Sections& sections, const StateSpace& system) {
  const double final_value = sections.dc_gain();
  if (!std::isfinite(final_value) || final_value == 0.0) return std::nullopt;
  if (!std::ranges::all_of(sections.sections, &Section::is_stable)) return std::nullopt;
  constexpr double kBand = 0.02;
  constexpr int kTimes = 2000;
  const auto n = static_cast<Eigen::Index>(system.order());
  const Eigen::Map<const Eigen::VectorXd> c(system.c.data(), n);
  const double interval = (response_duration_s(sections) - sections.delay_s) / kTimes;
  const auto share = [&](const Eigen::VectorXd& state) {
    return (c.dot(state.head(n)) + system.d) / final_value;
  };
  Eigen::VectorXd state = Eigen::VectorXd::Zero(n + 1);
  state(n) = 1.0;
  const Eigen::MatrixXd step = propagator(system, interval);
  TimeResponse::Figures out;
  out.final_value = final_value;
  double most = 1.0, last = share(state), low_s = NAN, high_s = NAN;
  double settled_from = NAN;
  Eigen::VectorXd before_settled;
  const auto beyond = [](double value) { return std::abs(value - 1.0) - kBand; };
  const auto outside = [&](double value) { return beyond(value) > 0.0; };
  /// Where within the interval behind a state the share is at a zero of `f`.
  const auto crossing = [&](const Eigen::VectorXd& from, const auto& f) {
    return root_between([&](double t) { return f(share(propagator(system, t) * from)); }, 0.0, interval);
  };
  // Poles that are equal take longer than one of them.
  for (int k = 0; k < kTimes || (k < 20 * kTimes && std::abs(last - 1.0) > 0.1 * kBand); ++k) {
    const Eigen::VectorXd next = step * state;
    const double value = share(next);
    const auto first_above = [&](double level, double& time_s) {
      if (!std::isnan(time_s)) return;
      if (last >= level)
        time_s = k * interval;
      else if (value >= level)
        time_s = k * interval + crossing(state, [level](double at) { return at - level; });
    };
    first_above(0.1, low_s);
    first_above(0.9, high_s);
    if (outside(last) && !outside(value)) {
      settled_from = k * interval;
      before_settled = state;
    }
    most = std::max(most, value);
    state = next;
    last = value;
  }
  out.rise_s = high_s - low_s;
  if (std::isnan(out.rise_s) || outside(last)) return std::nullopt;
  if (before_settled.size() > 0)
    out.settling_s = sections.delay_s + settled_from + crossing(before_settled, beyond);
  constexpr double kRounding = 1e-12;
  out.overshoot_percent = most - 1.0 > kRounding ? 100.0 * (most - 1.0) : 0.0;
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
  out.figures = figures_of(sections, system);
  return out;
}

}  // namespace bodesmith
