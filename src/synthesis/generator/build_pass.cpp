#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "schematic/plain_number.hpp"
#include "synthesis/generator/build.hpp"

namespace bodesmith::generator {
namespace {

using schematic::plain_number;

constexpr double kSwitchLoad = 20e3;  // ohm behind a controller's switch

}  // namespace

void Builder::pass(const std::string& x, const std::string& out, int number) {
  const std::string tail = number == 1 ? "" : fmt::format("_{}", number);
  Pass one;
  one.from = x;
  one.x = over_stroke(x);
  one.out = out;
  const Powers made = powers(one, tail);
  // The output fixes the gain behind the switch, which the weights then follow.
  if (is_open()) {
    scale_branches_open();
  } else {
    subtraction(one, tail);
  }
  for (std::size_t b = 0; b < out_.branches.size(); ++b) branch(one, b, made);
  if (is_open()) output(one);
  out_.passes.push_back(std::move(one));
}

int Builder::groups(const std::vector<double>& a) const {
  return std::max(1, (degree(a) + size_ - 1) / size_);
}

/// a_{jg+1} …: coefficients of P_j.
std::vector<double> Builder::group_coefficients(const std::vector<double>& a, int j) const {
  std::vector<double> out;
  for (int i = 0; i < size_; ++i) {
    const auto k = static_cast<std::size_t>(j * size_ + i);
    out.push_back(k < a.size() ? a[k] : 0.0);
  }
  return out;
}

/// Volts of the chain node T_j per unit of h_j, for one volt of T_0 per unit of d: each product x^g T/U
/// costs U^-g.
double Builder::chain_scale(int j) const {
  return std::pow(options_.multiplier.scale_v, size_ * j);
}

/// Greatest |voltage| of any sum or product of a branch for 1 V per unit of d.
double Builder::greatest_inside(const std::vector<double>& a) const {
  double out = 0.0;
  for (int j = 0; j < groups(a); ++j) {
    const std::vector<double> tail(a.begin() + std::min<long>(j * size_, static_cast<long>(a.size())),
                                   a.end());
    out = std::max({out, chain_scale(j) * peak(tail), chain_scale(j) * peak(group_coefficients(a, j))});
  }
  return out;
}

Powers Builder::powers(Pass& pass, const std::string& tail) {
  std::vector<bool> needed(kMostPowers + 1, false);
  for (const Branch& one : out_.branches) {
    const int count = groups(one.wanted);
    for (int j = 0; j < count; ++j) {
      const std::vector<double> a = group_coefficients(one.wanted, j);
      for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i] != 0.0) needed[i + 1] = true;
      }
    }
    if (count > 1) needed[static_cast<std::size_t>(size_)] = true;
  }
  enter(is_open() ? "powers (shared by the branches) and groups: W = X Y/U + Z" : "powers" + tail,
        Purpose::powers);
  Powers out{.x = pass.x, .scaled = pass.x, .tail = tail};
  const double range = out_.multiplier.greatest_input_v;
  if (out_.stroke) {
    out.scale = out.first = out_.stroke->argument_scale;
  } else if (std::any_of(needed.begin() + 2, needed.end(), [](bool one) { return one; }) &&
             top() > range * 1.005) {
    // Thevenin's resistance of the divider drives multiplier inputs only.
    out.scaled = "x" + tail;
    const double lower = 2e3, upper = lower * (top() / (kRoom * range) - 1.0);
    const int above = resistor("Rv1" + tail, "divider before the multipliers", pass.x, out.scaled, upper);
    const int below = resistor("Rv2" + tail, "divider before the multipliers", out.scaled, "0", lower);
    out.scale = out_.part(below).realised / (out_.part(below).realised + out_.part(above).realised);
  }
  make_powers(out, std::move(needed), top());
  for (const int one : out.multipliers) {
    const Multiplier& m = out_.multipliers[static_cast<std::size_t>(one)];
    if (is_open()) warn_above(m.name, m.peak_v);
  }
  pass.multipliers = out.multipliers;
  return out;
}

void Builder::branch(Pass& pass, std::size_t number, const Powers& powers) {
  Branch& b = out_.branches[number];
  b.realised.assign(b.wanted.size(), 0.0);
  pass.branch_opamp.push_back(-1);
  std::string node = "b" + letter(number) + powers.tail;
  // The open circuit's output amplifier turns the sign.
  const double gain = (is_open() ? -1.0 : 1.0) * out_.branch_gain * b.rate.at_rest * b.amplitude.at_rest;
  const int count = groups(b.wanted);
  std::string inner;
  for (int j = count - 1; j >= 0; --j) {
    const std::vector<double> a = group_coefficients(b.wanted, j);
    const bool zero = std::ranges::all_of(a, [](double one) { return one == 0.0; });
    std::string added = "0";
    const double volts = gain * chain_scale(j);
    if (!zero) {
      added = count == 1 ? node : fmt::format("{}{}{}", j == count - 1 ? "t" : "z", letter(number), j);
      enter(count == 1 ? b.name + powers.tail : fmt::format("{}: {}", b.name, added), Purpose::branch);
      const WeightedSum made = weighted_sum(powers, a, volts, number, added, j * size_ + 1,
                                            count == 1 ? "" : fmt::format("_{}", j));
      pass.branch_opamp.back() = made.opamp;
      out_.noise_gain = std::max(out_.noise_gain, made.noise_gain);
      for (std::size_t k = 0; k < a.size(); ++k) {
        if (a[k] != 0.0) b.realised[static_cast<std::size_t>(j * size_) + k] = made.realised[k];
      }
    }
    if (j == count - 1) {
      inner = added;
      continue;
    }
    const std::string out = j == 0 ? node : fmt::format("t{}{}", letter(number), j);
    const std::vector<double> tail(b.wanted.begin() + j * size_, b.wanted.end());
    enter("powers (shared by the branches) and groups: W = X Y/U + Z", Purpose::powers);
    // M2 to M7 are the powers.
    multiplier(fmt::format("M{}{}", letter(number).empty() ? "c" : letter(number), j),
               fmt::format("group {} of {}", j, b.name), powers.node(size_), inner, added, out,
               std::abs(volts) * peak(tail));
    inner = out;
  }
  if (inner == "0") node = "0";
  const double peak_v = out_.branch_gain * b.greatest_rate * (is_open() ? peak(b.realised) : peak_of(number));
  b.peak_v = peak_v * b.greatest_amplitude;
  if (node != "0") {
    node = vary(GainCurve::over_rate(), b.rate, number, node, powers.tail, peak_v * b.amplitude.at_rest);
    if (out_.amplitude && b.amplitude.control >= 0) {
      enter("amplitude gain, " + b.name, Purpose::amplitude);
      out_.amplitude->multipliers.push_back(static_cast<int>(out_.multipliers.size()));
    }
    node = vary(GainCurve::over_amplitude(), b.amplitude, number, node, powers.tail, b.peak_v);
  }
  b.out = node;
  for (int i = 0; i <= kPolynomialPoints; ++i) {
    const double x = static_cast<double>(i) / kPolynomialPoints;
    b.max_error_percent =
        std::max(b.max_error_percent, 100.0 * std::abs(polynomial(b.realised, x) - polynomial(b.wanted, x)));
  }
  out_.max_error_percent = std::max(out_.max_error_percent, b.max_error_percent);
  if (is_open()) return;
  enter("switch" + powers.tail, Purpose::branch_switch);
  out_.contacts.push_back({"S" + letter(number) + powers.tail, group, node, "sw" + powers.tail,
                           number == 0 ? "up" : "down", static_cast<int>(number)});
}

void Builder::output(Pass& pass) {
  enter("back to 1 V per unit of d", Purpose::output);
  const std::string source = out_.switched() ? "sw" : out_.branches.front().out;
  pass.output.disturbance = resistor("Rin", "output amplifier, input", source, "mo", input_ohm_, input_ohm_);
  pass.output.feedback =
      resistor("Rg", "output amplifier, feedback", "mo", pass.out, feedback_ohm_, feedback_ohm_);
  pass.output.opamp = opamp("output amplifier", "0", "mo", pass.out);
}

/// v = r (Rr2/(Rr1 + Rr2)) (1 + Rg/(Rin + Ron)) - Rg/(Rin + Ron) sw, the first product 1.
void Builder::subtraction(Pass& pass, const std::string& tail) {
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

/// Levels of the lines, a decoder and a contact for every branch.
void Builder::branch_switch() {
  const SwitchModel& model = out_.analog_switch;
  const auto level = [&](const std::string& pin, const std::string& node) {
    out_.comparators.push_back({group, pin, node, 40.0, 0.5});
  };
  group = add_group(fmt::format("branch switch, {}: {} ohm, closes {} s and opens {} s after its control",
                                model.name, plain_number(model.on_ohm), plain_number(model.on_delay_s),
                                plain_number(model.off_delay_s())),
                    Purpose::branch_switch);
  level("branch", "lb");
  for (int line = 1; line <= out_.select_lines(); ++line)
    level(fmt::format("select{}", line), fmt::format("l{}", line));
  for (std::size_t b = 0; b < out_.branches.size(); ++b) {
    const std::size_t channel = add_group("", Purpose::branch_switch);
    out_.gates.push_back(decoded(static_cast<int>(b), channel));
    out_.contacts.push_back({fmt::format("S{}", b + 1), channel, out_.branches[b].out, "sw",
                             fmt::format("e{}", b + 1), static_cast<int>(b)});
  }
}

/// 1 when the lines (levels lb, l1, l2, …) select this branch.
schematic::Gate Builder::decoded(int branch, std::size_t channel) const {
  schematic::Gate out{channel, fmt::format("e{}", branch + 1), {}, {}};
  const int lines = out_.select_lines();
  for (int select = 0; select < (1 << lines); ++select) {
    const bool up = out_.branch_at(select, true) == branch, down = out_.branch_at(select, false) == branch;
    if (!up && !down) continue;
    if (up != down) (up ? out.high : out.low).push_back("lb");
    for (int bit = 0; bit < lines; ++bit)
      (((select >> bit) & 1) != 0 ? out.high : out.low).push_back(fmt::format("l{}", bit + 1));
    break;
  }
  return out;
}

}  // namespace bodesmith::generator
