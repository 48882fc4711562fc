#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/controller/build.hpp"
#include "synthesis/parts/summing_amplifier.hpp"

namespace bodesmith::controller {
namespace {

constexpr int kDrivePoints = 1000;
constexpr double kSwitchLoad = 20e3;  // ohm behind the switch

}  // namespace

/// Greatest |d| of a branch over the drives that occur.
double Builder::peak_of(int b) const {
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
  for (const int b : {0, 1}) top = std::max(top, greatest_gain_[b] * greatest_amplitude_[b] * peak_of(b));
  if (!(top > 1e-4)) {
    throw DesignError(fmt::format(
        "the disturbance is at most {} of the range: there is nothing to compensate", rounded_text(top)));
  }
  out_.branch_gain = std::min(kRoom * out_.multiplier.greatest_input_v / top, 50.0);
}

void Builder::pass(const std::string& x, const std::string& out, int number) {
  const std::string tail = number == 1 ? "" : fmt::format("_{}", number);
  Pass one;
  one.from = x;
  one.x = over_stroke(x);
  one.out = out;
  powers(one, tail);
  // The subtraction fixes the gain behind the switch, which the weights then follow.
  output(one, tail);
  for (const int b : {0, 1}) branch(one, b, tail);
  out_.passes.push_back(std::move(one));
}

void Builder::powers(Pass& pass, const std::string& tail) {
  enter("powers" + tail);
  const double top = std::max(out_.loop.greatest_drive, 1.0), range = out_.multiplier.greatest_input_v;
  std::string scaled = pass.x;
  double scale = out_.stroke ? out_.stroke->argument_scale : 1.0;
  pass_scale_ = scale;
  const auto& a = disturbance_.ascending;
  const auto& d = disturbance_.descending;
  const bool cubes = a[2] != 0.0 || d[2] != 0.0, squares = cubes || a[1] != 0.0 || d[1] != 0.0;
  if (!squares) return;
  if (!out_.stroke && top > range * 1.005) {
    // Thevenin's resistance of the divider drives multiplier inputs only.
    scaled = "x" + tail;
    const double lower = 2e3, upper = lower * (top / (kRoom * range) - 1.0);
    const int above = resistor("Rv1" + tail, "divider before the multipliers", pass.x, scaled, upper);
    const int below = resistor("Rv2" + tail, "divider before the multipliers", scaled, "0", lower);
    scale = lower / (lower + out_.part(above).realised);
    pass_scale_ = out_.part(below).realised / (out_.part(below).realised + out_.part(above).realised);
  }
  const double x = scale * top, u = out_.multiplier.scale_v;
  pass.square = multiplier("M2" + tail, "x^2/U", scaled, scaled, "0", "x2" + tail, x * x / u);
  if (cubes) {
    pass.cube =
        multiplier("M3" + tail, "x^3/U^2", "x2" + tail, scaled, "0", "x3" + tail, x * x * x / (u * u));
  }
}

void Builder::branch(Pass& pass, int b, const std::string& tail) {
  const std::array<double, 3>& a = disturbance_.coefficients(kBranches[b]);
  const std::string name = branch_name(b), letter = branch_letter(b);
  enter(name + tail);
  std::string node = "0";
  if (a != std::array<double, 3>{}) {
    const double u = out_.multiplier.scale_v,
                 volts = out_.branch_gain * out_.rate[b].at_rest * out_.amplitude[b].at_rest;
    const double scale = pass_scale_;
    const std::vector<double> level = {out_.stroke ? scale : 1.0, scale * scale / u,
                                       scale * scale * scale / (u * u)};
    const std::vector<std::string> from = {pass.x, "x2" + tail, "x3" + tail};
    std::vector<double> gains;
    std::vector<Weight> weights;
    for (std::size_t k = 0; k < 3; ++k) {
      gains.push_back(volts * a[k] / level[k]);
      weights.push_back({from[k], fmt::format("R{}{}{}", letter, k + 1, tail),
                         fmt::format("weight of x^{}, {}", k + 1, name)});
    }
    const synthesis::SummingDesign design =
        synthesis::search_summing_resistors(gains, level, options_.resistors);
    node = "b" + letter + tail;
    pass.branch_opamp[b] = sum(weights, gains, design, "R" + letter, tail, name, "sum of the powers, " + name,
                               "p" + letter + tail, "m" + letter + tail, node)
                               .opamp;
    double peak_v = greatest_gain_[b] * out_.amplitude[b].at_rest * out_.branch_gain * peak_of(b);
    const auto vary = [&](const BranchGain& gain, const char* what, const std::string& multiplier_name,
                          const std::string& control, const std::string& to) {
      if (gain.control < 0) return;
      multiplier(multiplier_name + letter + tail, fmt::format("{} gain, {}", what, name), node,
                 control + letter, node, to + letter + tail, peak_v);
      node = to + letter + tail;
    };
    vary(out_.rate[b], "rate", "M", "c", "g");
    peak_v *= greatest_amplitude_[b] / out_.amplitude[b].at_rest;
    vary(out_.amplitude[b], "amplitude", "Mh", "h", "j");
  }
  enter("switch" + tail);
  out_.contacts.push_back({"S" + letter + tail, group, node, "sw" + tail, b == 0 ? "up" : "down", b});
}

/// v = r (Rr2/(Rr1 + Rr2)) (1 + Rg/(Rin + Ron)) - Rg/(Rin + Ron) sw, the first product 1.
void Builder::output(Pass& pass, const std::string& tail) {
  enter("subtraction" + tail);
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
