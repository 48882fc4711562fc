#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/controller/build.hpp"

namespace bodesmith::controller {
namespace {

constexpr int kDrivePoints = 1000;
constexpr double kSwitchLoad = 20e3;  // ohm behind the switch

}  // namespace

/// Greatest |d| of a branch over the drives that occur.
double Builder::peak_of(std::size_t b) const {
  double out = 0.0;
  for (int i = 0; i <= kDrivePoints; ++i) {
    const double x = std::max(out_.loop.greatest_drive, 1.0) * i / kDrivePoints;
    out = std::max(out, std::abs(disturbance_.value(kBranches[b], x)));
  }
  return out;
}

/// V per unit of K d at the switch: the greater branch uses the multipliers' range.
void Builder::scale_branches() {
  double top = 0.0;
  for (std::size_t b = 0; b < 2; ++b)
    top = std::max(top, greatest_gain_[b] * greatest_amplitude_[b] * peak_of(b));
  if (!(top > 1e-4)) {
    throw DesignError(fmt::format(
        "the disturbance is at most {} of the range: there is nothing to compensate", rounded_text(top)));
  }
  out_.branch_gain = std::min(generator::kRoom * out_.multiplier.greatest_input_v / top, 50.0);
}

void Builder::pass(const std::string& x, const std::string& out, int number) {
  const std::string tail = number == 1 ? "" : fmt::format("_{}", number);
  Pass one;
  one.from = x;
  one.x = over_stroke(x);
  one.out = out;
  const generator::Powers made = powers(one, tail);
  // The subtraction fixes the gain behind the switch, which the weights then follow.
  output(one, tail);
  for (std::size_t b = 0; b < 2; ++b) branch(one, b, made);
  out_.passes.push_back(std::move(one));
}

generator::Powers Builder::powers(Pass& pass, const std::string& tail) {
  enter("powers" + tail, Purpose::powers);
  const double top = std::max(out_.loop.greatest_drive, 1.0), range = out_.multiplier.greatest_input_v;
  generator::Powers out{.x = pass.x, .scaled = pass.x, .tail = tail};
  if (out_.stroke) out.scale = out.first = out_.stroke->argument_scale;
  const auto uses = [&](std::size_t k) {
    return disturbance_.ascending[k] != 0.0 || disturbance_.descending[k] != 0.0;
  };
  const std::vector<bool> needed = {false, false, uses(1), uses(2)};
  if ((uses(1) || uses(2)) && !out_.stroke && top > range * 1.005) {
    // Thevenin's resistance of the divider drives multiplier inputs only.
    out.scaled = "x" + tail;
    const double lower = 2e3, upper = lower * (top / (generator::kRoom * range) - 1.0);
    const int above = resistor("Rv1" + tail, "divider before the multipliers", pass.x, out.scaled, upper);
    const int below = resistor("Rv2" + tail, "divider before the multipliers", out.scaled, "0", lower);
    out.scale = out_.part(below).realised / (out_.part(below).realised + out_.part(above).realised);
  }
  make_powers(out, needed, top);
  pass.multipliers = out.multipliers;
  return out;
}

void Builder::branch(Pass& pass, std::size_t b, const generator::Powers& powers) {
  const std::array<double, 3>& a = disturbance_.coefficients(kBranches[b]);
  enter(name(b) + powers.tail, Purpose::branch);
  std::string node = "0";
  if (a != std::array<double, 3>{}) {
    node = "b" + letter(b) + powers.tail;
    pass.branch_opamp[b] =
        weighted_sum(powers, {a.begin(), a.end()},
                     out_.branch_gain * out_.rate[b].at_rest * out_.amplitude[b].at_rest, b, node)
            .opamp;
    const double peak_v = greatest_gain_[b] * out_.branch_gain * peak_of(b);
    node = vary(generator::GainCurve::over_rate(), out_.rate[b], b, node, powers.tail,
                peak_v * out_.amplitude[b].at_rest);
    node = vary(generator::GainCurve::over_amplitude(), out_.amplitude[b], b, node, powers.tail,
                peak_v * greatest_amplitude_[b]);
  }
  enter("switch" + powers.tail, Purpose::branch_switch);
  out_.contacts.push_back({"S" + letter(b) + powers.tail, group, node, "sw" + powers.tail,
                           b == 0 ? "up" : "down", static_cast<int>(b)});
}

/// v = r (Rr2/(Rr1 + Rr2)) (1 + Rg/(Rin + Ron)) - Rg/(Rin + Ron) sw, the first product 1.
void Builder::output(Pass& pass, const std::string& tail) {
  enter("subtraction" + tail, Purpose::output);
  const double on = out_.analog_switch.on_ohm;
  const double input = options_.resistors.nearest(kSwitchLoad);
  const double feedback = options_.resistors.nearest_above((input + on) / out_.branch_gain);
  out_.branch_gain = (input + on) / feedback;
  // The pair whose ratio comes nearest: the reference's own gain must not depend on rounding.
  const double ratio = (input + on) / feedback;
  double upper = feedback, lower = input, best = 1.0;
  for (const double r : options_.resistors.is_exact() ? std::vector<double>{input + on}
                                                      : options_.resistors.values(0.5 * input, 5.0 * input)) {
    const double other = options_.resistors.nearest(r / ratio);
    const double off = std::abs(r / other / ratio - 1.0);
    if (off < best) {
      best = off;
      lower = r;
      upper = other;
    }
  }
  // Both contacts are open for a moment, and an opening one leaves its charge here.
  capacitor("Csw" + tail, "holds the disturbance while the switch changes", "sw" + tail, "0", 100e-12);
  const std::string plus = "po" + tail, minus = "mo" + tail;
  Pass::Output& parts = pass.output;
  parts.reference = resistor("Rr1" + tail, "reference", "r", plus, lower / ratio, upper);
  parts.disturbance = resistor("Rin" + tail, "disturbance", "sw" + tail, minus, input, input);
  parts.feedback = resistor("Rg" + tail, "feedback of the subtraction", minus, pass.out, feedback, feedback);
  resistor("Rr2" + tail, "reference", plus, "0", lower, lower);
  parts.opamp = opamp("subtraction", plus, minus, pass.out);
}

}  // namespace bodesmith::controller
