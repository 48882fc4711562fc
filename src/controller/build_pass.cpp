#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuit/parts/summing_amplifier.hpp"
#include "controller/build.hpp"

namespace bodesmith::controller {
namespace {

constexpr int kDrivePoints = 1000;
constexpr double kSwitchLoad = 20e3;  // ohm behind the switch

std::string letter_of(int b) {
  return b == 0 ? "a" : "d";
}

}  // namespace

/// Greatest |d| of a branch over the drives that occur.
double Builder::peak_of(int b) const {
  double out = 0.0;
  for (int i = 0; i <= kDrivePoints; ++i) {
    const double x = std::max(out_.loop.greatest_drive, 1.0) * i / kDrivePoints;
    out = std::max(out, std::abs(disturbance_.value(out_.rate[b].which, x)));
  }
  return out;
}

/// V per unit of K d at the switch: the greater branch uses the multipliers' range.
void Builder::scale_branches() {
  double top = 0.0;
  for (const int b : {0, 1}) top = std::max(top, greatest_gain_[b] * peak_of(b));
  if (!(top > 1e-4)) {
    throw DesignError(fmt::format(
        "the disturbance is at most {} of the range: there is nothing to compensate", rounded_text(top)));
  }
  out_.branch_gain = std::min(kRoom * out_.multiplier.greatest_input_v / top, 50.0);
}

void Builder::pass(const std::string& x, const std::string& out, int number) {
  const std::string tail = number == 1 ? "" : fmt::format("_{}", number);
  Pass one;
  one.x = x;
  one.out = out;
  powers(one, tail);
  // The subtraction fixes the gain behind the switch, which the weights then follow.
  output(one, tail);
  for (const int b : {0, 1}) branch(one, b, tail);
  out_.passes.push_back(std::move(one));
}

void Builder::powers(Pass& pass, const std::string& tail) {
  group("powers" + tail);
  const double top = std::max(out_.loop.greatest_drive, 1.0), range = out_.multiplier.greatest_input_v;
  pass.scaled = pass.x;
  double scale = 1.0;
  const auto& a = disturbance_.ascending;
  const auto& d = disturbance_.descending;
  const bool cubes = a[2] != 0.0 || d[2] != 0.0, squares = cubes || a[1] != 0.0 || d[1] != 0.0;
  if (!squares) return;
  if (top > range * 1.005) {
    // Thevenin's resistance of the divider drives multiplier inputs only.
    pass.scaled = "x" + tail;
    const double lower = 2e3, upper = lower * (top / (kRoom * range) - 1.0);
    pass.divider[0] = resistor("Rv1" + tail, "divider before the multipliers", pass.x, pass.scaled, upper);
    pass.divider[1] = resistor("Rv2" + tail, "divider before the multipliers", pass.scaled, "0", lower);
    scale = lower / (lower + out_.part(pass.divider[0]).realised);
  }
  const double x = scale * top, u = out_.multiplier.scale_v;
  pass.square = multiplier("M2" + tail, "x^2/U", pass.scaled, pass.scaled, "0", "x2" + tail, x * x / u);
  if (cubes) {
    pass.cube =
        multiplier("M3" + tail, "x^3/U^2", "x2" + tail, pass.scaled, "0", "x3" + tail, x * x * x / (u * u));
  }
}

void Builder::branch(Pass& pass, int b, const std::string& tail) {
  const std::array<double, 3>& a = b == 0 ? disturbance_.ascending : disturbance_.descending;
  BranchPath path;
  path.which = out_.rate[b].which;
  const std::string name = b == 0 ? "ascending" : "descending", letter = letter_of(b);
  group(name + tail);
  std::string node = "0";
  if (a != std::array<double, 3>{}) {
    double scale = 1.0;
    if (pass.divider[0] >= 0) {
      const double lower = out_.part(pass.divider[1]).realised;
      scale = lower / (lower + out_.part(pass.divider[0]).realised);
    }
    const double u = out_.multiplier.scale_v, volts = out_.branch_gain * out_.rate[b].at_rest;
    const std::vector<double> level = {1.0, scale * scale / u, scale * scale * scale / (u * u)};
    const std::vector<std::string> from = {pass.x, "x2" + tail, "x3" + tail};
    std::vector<double> gains;
    for (std::size_t k = 0; k < 3; ++k) gains.push_back(volts * a[k] / level[k]);
    const circuit::SummingDesign design = circuit::search_summing_resistors(gains, level, options_.resistors);
    const std::string plus = "p" + letter + tail, minus = "m" + letter + tail;
    node = "b" + letter + tail;
    Sum sum;
    bool plus_used = false;
    for (std::size_t k = 0; k < 3; ++k) {
      if (gains[k] == 0.0) continue;
      const bool at_plus = gains[k] > 0.0;
      plus_used = plus_used || at_plus;
      const int part = resistor(fmt::format("R{}{}{}", letter, k + 1, tail),
                                fmt::format("weight of x^{}, {}", k + 1, name), from[k],
                                at_plus ? plus : minus, design.exact.weights[k], design.realised.weights[k]);
      sum.terms.push_back({from[k], part, at_plus, 0.0});
    }
    sum.feedback = resistor("R" + letter + "f" + tail, "feedback of the sum, " + name, minus, node,
                            design.exact.feedback, design.realised.feedback);
    if (design.realised.balance > 0.0) {
      sum.balance_at_plus = design.realised.balance_at_plus;
      sum.balance =
          resistor("R" + letter + "b" + tail, "balance of the sum, " + name,
                   sum.balance_at_plus ? plus : minus, "0", design.exact.balance, design.realised.balance);
    }
    sum.opamp = opamp("sum of the powers, " + name, plus_used ? plus : "0", minus, node);
    out_.sums.push_back(std::move(sum));
    path.sum = static_cast<int>(out_.sums.size()) - 1;
    if (out_.rate[b].control >= 0) {
      const double peak_v = greatest_gain_[b] * out_.branch_gain * peak_of(b);
      path.gain = multiplier("M" + letter + tail, "rate gain, " + name, node, "c" + letter, node,
                             "g" + letter + tail, peak_v);
      node = "g" + letter + tail;
    }
  }
  group("switch" + tail);
  out_.contacts.push_back({"S" + letter + tail, group_, node, "sw" + tail, b == 0 ? "up" : "down", b});
  path.contact = static_cast<int>(out_.contacts.size()) - 1;
  pass.branch.push_back(path);
}

/// v = r (Rr2/(Rr1 + Rr2)) (1 + Rg/(Rin + Ron)) - Rg/(Rin + Ron) sw, the first product 1.
void Builder::output(Pass& pass, const std::string& tail) {
  group("subtraction" + tail);
  const double on = out_.analog_switch.on_ohm;
  const double input = options_.resistors.nearest(kSwitchLoad);
  double feedback = options_.resistors.nearest((input + on) / out_.branch_gain);
  if ((input + on) / feedback > out_.branch_gain) {
    for (const double r : options_.resistors.values(feedback, feedback * 2.5)) {
      if ((input + on) / r > out_.branch_gain) continue;
      feedback = r;
      break;
    }
  }
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
  Sum sum;
  const std::string plus = "po" + tail, minus = "mo" + tail;
  sum.terms.push_back({"r", resistor("Rr1" + tail, "reference", "r", plus, lower / ratio, upper), true, 0.0});
  sum.terms.push_back(
      {"sw" + tail, resistor("Rin" + tail, "disturbance", "sw" + tail, minus, input, input), false, on});
  sum.feedback = resistor("Rg" + tail, "feedback of the subtraction", minus, pass.out, feedback, feedback);
  sum.balance_at_plus = true;
  sum.balance = resistor("Rr2" + tail, "reference", plus, "0", lower, lower);
  sum.opamp = opamp("subtraction", plus, minus, pass.out);
  out_.sums.push_back(std::move(sum));
  pass.output = static_cast<int>(out_.sums.size()) - 1;
}

}  // namespace bodesmith::controller
