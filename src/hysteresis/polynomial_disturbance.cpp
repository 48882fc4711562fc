#include "hysteresis/polynomial_disturbance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/units.hpp"
#include "numeric/optimisation/root.hpp"

namespace bodesmith::hysteresis {
namespace {

void read_common(const Parameters& values, PolynomialDisturbance& out) {
  out.nested = values.word("minor") == "nested";
  out.amplitude = values.number("amplitude");
  out.switch_delay_s = values.number("switch_delay_s");
  out.strokes = {values.list("alpha"), values.list("alpha_1"), values.list("alpha_2")};
  const std::vector<double>& alpha = out.strokes.alpha;
  if (out.strokes.ascending.size() != alpha.size() || out.strokes.descending.size() != alpha.size())
    throw DesignError(fmt::format("alpha, alpha_1, alpha_2 have {}, {} and {} numbers, expected one length",
                                  alpha.size(), out.strokes.ascending.size(), out.strokes.descending.size()));
  for (std::size_t i = 1; i < alpha.size(); ++i)
    if (!(alpha[i] > alpha[i - 1])) throw DesignError("alpha does not rise");
  Disturbance rates;
  for (const double f : values.list("rate_frequency_hz")) rates.rate.frequency.push_back(Hertz{f});
  rates.rate.ascending = values.list("rate_ascending");
  rates.rate.descending = values.list("rate_descending");
  if (rates.rate.ascending.size() != rates.rate.frequency.size() ||
      rates.rate.descending.size() != rates.rate.frequency.size())
    throw DesignError("rate_frequency_hz, rate_ascending and rate_descending differ in length");
  for (std::size_t i = 1; i < rates.rate.frequency.size(); ++i)
    if (!(rates.rate.frequency[i] > rates.rate.frequency[i - 1]))
      throw DesignError("rate_frequency_hz does not rise");
  const double operating = values.number("operating_hz");
  if (operating > 0.0 && !rates.rate.frequency.empty()) {
    out.rate_gain_ascending = rates.rate_gain(Disturbance::Branch::ascending, Hertz{operating});
    out.rate_gain_descending = rates.rate_gain(Disturbance::Branch::descending, Hertz{operating});
  }
}

std::array<double, 3> three(const Parameters& values, std::string_view name) {
  const std::vector<double>& numbers = values.list(name);
  if (numbers.size() != 3)
    throw DesignError(fmt::format("{} has {} numbers, expected [a1, a2, a3]", name, numbers.size()));
  return {numbers[0], numbers[1], numbers[2]};
}

/// Newton's steps double the right digits as long as the branch is far from flat; otherwise the bracket is quicker.
constexpr int kNewtonSteps = 12;
constexpr double kLeastSlope = 0.2;
constexpr double kRounding = 4e-16;

/// The branch as a function on its interval, see the header.
struct NestedBranch {
  double x_lo, x_hi, y_lo, y_hi, gain, end_0, end_1;
  const BranchShape* shape;

  double value(double x) const {
    if (!(x_hi > x_lo)) return y_hi + (x - x_hi);
    const double s = (x - x_lo) / (x_hi - x_lo);
    if (s > 1.0) return y_hi + (x - x_hi);
    if (s < 0.0) return y_lo + (x - x_lo);
    return y_lo + s * (y_hi - y_lo) + gain * (shape->value(s) - end_0 - s * (end_1 - end_0));
  }
};

NestedBranch nested_branch(const PolynomialDisturbance& model, const PolynomialDisturbance::Turn& from,
                           const PolynomialDisturbance::Turn* toward, int direction) {
  const bool rising = direction > 0;
  double end_x = 0.0;
  double end_y = 0.0;
  if (toward != nullptr) {
    end_x = toward->u;
    end_y = toward->y;
  } else if (rising) {
    end_x = std::max(1.0, from.u);
    end_y = from.u < 1.0 ? 1.0 : from.y;
  } else {
    end_x = std::min(0.0, from.u);
    end_y = from.u > 0.0 ? 0.0 : from.y;
  }
  NestedBranch out{};
  out.shape = rising ? &model.ascending : &model.descending;
  out.x_lo = rising ? from.u : end_x;
  out.y_lo = rising ? from.y : end_y;
  out.x_hi = rising ? end_x : from.u;
  out.y_hi = rising ? end_y : from.y;
  out.gain = model.strokes.at(branch_of(rising), out.x_hi - out.x_lo) *
             (rising ? model.rate_gain_ascending : model.rate_gain_descending);
  out.end_0 = out.shape->value(0.0);
  out.end_1 = out.shape->value(1.0);
  return out;
}

}  // namespace

double BranchShape::value(double s) const {
  if (is_sine) return sine * std::sin(std::numbers::pi * s);
  return s * (polynomial[0] + s * (polynomial[1] + s * polynomial[2]));
}

double BranchShape::slope(double s) const {
  if (is_sine) return sine * std::numbers::pi * std::cos(std::numbers::pi * s);
  return polynomial[0] + s * (2.0 * polynomial[1] + 3.0 * s * polynomial[2]);
}

PolynomialDisturbance PolynomialDisturbance::from(const Parameters& values) {
  PolynomialDisturbance out;
  if (values.has("A_ascending")) {
    out.ascending.is_sine = out.descending.is_sine = true;
    out.ascending.sine = values.number("A_ascending");
    out.descending.sine = values.number("A_descending");
  } else {
    out.ascending.polynomial = three(values, "ascending");
    out.descending.polynomial = three(values, "descending");
    out.constant_ascending = values.number("constant_ascending");
    out.constant_descending = values.number("constant_descending");
  }
  read_common(values, out);
  if (out.nested && (out.constant_ascending != 0.0 || out.constant_descending != 0.0))
    throw DesignError("constant_ascending and constant_descending need minor = slope_sign");
  return out;
}

double PolynomialDisturbance::output(const Turn& from, const Turn* toward, int direction, double x) const {
  return nested_branch(*this, from, toward, direction).value(x);
}

double PolynomialDisturbance::input(const Turn& from, const Turn* toward, int direction, double y,
                                    double now) const {
  const NestedBranch branch = nested_branch(*this, from, toward, direction);
  const double end = direction > 0 ? branch.x_hi : branch.x_lo;
  const double end_y = direction > 0 ? branch.y_hi : branch.y_lo;
  if ((y - end_y) * direction >= 0.0) return end + (y - end_y);
  return root_between([&](double x) { return branch.value(x) - y; }, std::min(now, end), std::max(now, end));
}

PolynomialDisturbance::PlainBranch PolynomialDisturbance::plain_branch(bool rising) const {
  return {rising ? ascending : descending,
          strokes.at(branch_of(rising), amplitude) * (rising ? rate_gain_ascending : rate_gain_descending),
          amplitude, rising ? constant_ascending : constant_descending};
}

double PolynomialDisturbance::PlainBranch::value(double x) const {
  return x + gain * shape.value(x / amplitude) + constant;
}

std::array<double, 2> PolynomialDisturbance::PlainBranch::rising_part() const {
  const auto& a = shape.polynomial;
  const double steepness = gain / amplitude;
  std::array<double, 2> out{-INFINITY, INFINITY};
  const auto falls_from = [&](double s) {
    if (s < 0.5) out[0] = std::max(out[0], s * amplitude);
    if (s >= 0.5) out[1] = std::min(out[1], s * amplitude);
  };
  // A sine that rises with the chord on [0, 1] does so everywhere. A cubic: where 1 + k (a1 + 2 a2 s + 3 a3 s²) > 0.
  const double square = 3.0 * steepness * a[2];
  const double line = 2.0 * steepness * a[1];
  const double constant_part = 1.0 + steepness * a[0];
  const double discriminant = line * line - 4.0 * square * constant_part;
  if (square != 0.0 && discriminant > 0.0) {
    // Neither root by a difference of two nearly equal numbers.
    const double q = -0.5 * (line + std::copysign(std::sqrt(discriminant), line));
    falls_from(q / square);
    if (q != 0.0) falls_from(constant_part / q);
  } else if (square == 0.0 && line != 0.0) {
    falls_from(-constant_part / line);
  }
  return out;
}

std::optional<double> PolynomialDisturbance::PlainBranch::newton(double y) const {
  double x = y;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double slope = 1.0 + gain / amplitude * shape.slope(x / amplitude);
    if (!(slope > kLeastSlope)) break;
    const double step = (y - value(x)) / slope;
    x += step;
    if (std::abs(step) <= kRounding * std::max(std::abs(x), amplitude)) return x;
  }
  return std::nullopt;
}

double PolynomialDisturbance::plain(bool rising, double x) const {
  return plain_branch(rising).value(x);
}

double PolynomialDisturbance::input_on(bool rising, double y) const {
  const PlainBranch branch = plain_branch(rising);
  const auto [least, most] = branch.rising_part();
  if (const auto near = branch.newton(y); near && *near > least && *near < most) return *near;
  double low = 0.0;
  double high = amplitude;
  for (double reach = amplitude; low > least && branch.value(low) > y; reach *= 2.0)
    low = std::max(low - reach, least);
  for (double reach = amplitude; high < most && branch.value(high) < y; reach *= 2.0)
    high = std::min(high + reach, most);
  return root_between([&](double x) { return branch.value(x) - y; }, low, high);
}

PolynomialOperator::PolynomialOperator(PolynomialDisturbance model) : loops_(std::move(model), 4096) {
  reset(0.0);
}

double PolynomialOperator::reset(double u) {
  u_ = u;
  rising_ = true;
  branch_ = true;
  waiting_ = 0;
  // On the ascending branch from the lower end of the stroke: every other point would lie off the loop.
  loops_.start(std::min(u, 0.0), std::min(u, 0.0), 1);
  return loops_.rule().nested ? loops_.step(u) : loops_.rule().plain(true, u);
}

double PolynomialOperator::step(double u, double dt_s) {
  if (loops_.rule().nested) return loops_.step(u);
  const bool turned = u != u_ && (u > u_) != rising_;
  if (u != u_) rising_ = u > u_;
  u_ = u;
  if (!late()) return loops_.rule().plain(rising_, u);
  if (turned) {
    if (waiting_ == due_.size()) {  // turns far faster than the switch: the oldest two cancel
      std::copy(due_.begin() + 2, due_.end(), due_.begin());
      waiting_ -= 2;
    }
    due_[waiting_++] = loops_.rule().switch_delay_s;
  }
  std::size_t done = 0;
  for (std::size_t i = 0; i < waiting_; ++i) {
    due_[i] -= dt_s;
    if (due_[i] <= 0.0) ++done;
  }
  if (done % 2 == 1) branch_ = !branch_;
  std::copy(due_.begin() + static_cast<std::ptrdiff_t>(done),
            due_.begin() + static_cast<std::ptrdiff_t>(waiting_), due_.begin());
  waiting_ -= done;
  return loops_.rule().plain(branch_, u);
}

double PolynomialOperator::peek(double u, double dt_s) const {
  if (loops_.rule().nested) return loops_.peek(u);
  if (!late()) return loops_.rule().plain(u == u_ ? rising_ : u > u_, u);
  const bool turned = u != u_ && (u > u_) != rising_;
  std::size_t done = turned && loops_.rule().switch_delay_s <= dt_s ? 1 : 0;
  for (std::size_t i = 0; i < waiting_; ++i)
    if (due_[i] <= dt_s) ++done;
  return loops_.rule().plain(done % 2 == 1 ? !branch_ : branch_, u);
}

PolynomialInverse::PolynomialInverse(PolynomialDisturbance model) : forward_(std::move(model)) {
  const PolynomialDisturbance& rule = forward_.loops_.rule();
  for (const bool rising : {true, false}) {
    const BranchShape& shape = rising ? rule.ascending : rule.descending;
    const double rate = rising ? rule.rate_gain_ascending : rule.rate_gain_descending;
    // The steepest stroke counts: gain over length.
    double steepest = rule.strokes.alpha.empty() ? 1.0 : 0.0;
    for (const double alpha : rule.strokes.alpha)
      steepest = std::max(steepest, rule.strokes.at(branch_of(rising), alpha) / alpha);
    for (int i = 0; i <= 200; ++i) {
      if (!(1.0 + steepest * rate * shape.slope(i / 200.0) > 0.0))
        throw DesignError(fmt::format("the {} branch falls at x = {:.3g}: there is no inverse",
                                      rising ? "ascending" : "descending", i / 200.0));
    }
  }
  reset(0.0);
}

double PolynomialInverse::reset(double y) {
  y_ = y;
  rising_ = true;
  const PolynomialDisturbance& rule = forward_.loops_.rule();
  if (rule.nested) {
    forward_.reset(std::min(y, 0.0));
    return step(y, 0.0);
  }
  const double u = rule.input_on(true, y);
  achieved_ = forward_.reset(u);
  return u;
}

double PolynomialInverse::step(double y, double dt_s) {
  if (forward_.loops_.rule().nested) {
    const double u = forward_.loops_.invert(y);
    achieved_ = forward_.loops_.y();
    return u;
  }
  if (y != y_) rising_ = y > y_;
  y_ = y;
  const PolynomialDisturbance& rule = forward_.loops_.rule();
  const double now = forward_.u_;
  // The smallest move that takes the input to the other branch where it is.
  const double nudge = 1e-9 * rule.amplitude;
  double best = now;
  double best_error = INFINITY;
  for (const double u :
       {rule.input_on(rising_, y), rule.input_on(!rising_, y), now, now - nudge, now + nudge}) {
    const double error = std::abs(forward_.peek(u, dt_s) - y);
    // An earlier one stays unless a later one is better by more than rounding.
    if (!(error < best_error - 1e-12 * rule.amplitude)) continue;
    best = u;
    best_error = error;
  }
  achieved_ = forward_.step(best, dt_s);
  return best;
}

}  // namespace bodesmith::hysteresis
