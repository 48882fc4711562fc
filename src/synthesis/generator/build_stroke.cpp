#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/text.hpp"
#include "synthesis/generator/build.hpp"

/// Amplitude gains (disturbance paper, Fig. 2 and 3c, d): v = r - K g(alpha) d(v/alpha), alpha the reference's stroke.
namespace bodesmith::generator {
namespace {

/// Of it offsets of some millivolts are a tenth.
constexpr double kLeastStroke = 0.05;
/// Ohm before the op-amp that divides; nothing flows there.
constexpr double kDividerOhm = 10e3;

}  // namespace

/// The table's, closed from kLeastStroke on.
std::vector<double> Builder::strokes() const {
  if (is_open()) return out_.strokes();
  if (!out_.stroke) return {1.0};
  std::vector<double> out = {std::max(out_.disturbance.amplitude.alpha.front(), kLeastStroke)};
  for (const double alpha : out_.disturbance.amplitude.alpha) {
    if (alpha > out.back()) out.push_back(alpha);
  }
  return out;
}

/// Of branch b, at strokes().
std::vector<double> Builder::stroke_gains(std::size_t b) const {
  std::vector<double> out;
  if (is_open()) {
    out = input_.branches[b].amplitude;
    if (out.empty()) out.assign(input_.alpha.size(), 1.0);
    return out;
  }
  for (const double alpha : strokes()) out.push_back(out_.disturbance.amplitude.at(kBranches[b], alpha));
  return out;
}

/// Two capacitors in turn: the first follows r while it rises and keeps its peak while it falls, when the second takes it over.
/// No time constant stands between a hold that droops and a stroke that is forgotten late: a new stroke counts from its first
/// peak on. The greatest of what is held, r (a stroke that grows) and the least stroke is alpha.
void Builder::stroke_hold() {
  enter("stroke", Purpose::stroke);
  reference();
  double fastest =
      out_.disturbance.rate.frequency.empty() ? 100.0 : out_.disturbance.rate.frequency.back().value;
  for (const Hertz f : options_.tracked) fastest = std::max(fastest, f.value);
  // Late by on-resistance times capacitor at the fastest triangle, drooping by the open contact's leak over half a period of the
  // slowest: both shares of the stroke are the same,
  //   2 f_max R_on C = G_off/(2 f_min C).
  const schematic::SwitchModel& contact = out_.analog_switch;
  const double farad = options_.capacitors.nearest(
      std::clamp(std::sqrt(contact.off_siemens / (4.0 * options_.lowest.value * fastest * contact.on_ohm)),
                 1e-9, 100e-9));
  // A held peak leaks to its driver, half a stroke below it on average: one capacitor half a period, then the other.
  out_.stroke->droop = contact.off_siemens / (2.0 * options_.lowest.value * farad);
  out_.stroke->charge_v = contact.charge_c / farad;
  // v = r - K g(alpha) d(v/alpha) for an alpha that is too small.
  constexpr double kLess = 1.0 - 1e-3;
  for (std::size_t b = 0; b < 2; ++b) {
    for (const double alpha : strokes()) {
      const auto subtracted = [&](double held, double w) {
        return gain_limit(b, true) * out_.disturbance.amplitude.at(kBranches[b], held) *
               out_.disturbance.value(kBranches[b], w * alpha / held);
      };
      for (double w = 0.0; w <= 1.0; w += 0.01) {
        const double slope = (subtracted(alpha, w) - subtracted(kLess * alpha, w)) / (1.0 - kLess);
        out_.stroke->hold_error_percent =
            std::max(out_.stroke->hold_error_percent, 100.0 * std::abs(slope) * out_.stroke->held_off(alpha));
      }
    }
  }
  out_.stroke->follow.push_back(opamp("stroke, drives the first hold", "r", "rb", "rb"));
  out_.contacts.push_back({"Sp1", group, "rb", "h1", "up", 0});
  capacitor("Cp1", "stroke, peak of this rise", "h1", "0", farad);
  out_.stroke->follow.push_back(opamp("stroke, drives the second hold", "h1", "hb", "hb"));
  out_.contacts.push_back({"Sp2", group, "hb", "h2", "down", 1});
  capacitor("Cp2", "stroke, last peak", "h2", "0", farad);
  const double lower = 1e3;
  const int up =
      resistor("Rp1", "least stroke", "vr", "hl", lower * (kReferenceV / out_.stroke->least - 1.0));
  const int down = resistor("Rp2", "least stroke", "hl", "0", lower);
  out_.stroke->least =
      kReferenceV * out_.part(down).realised / (out_.part(down).realised + out_.part(up).realised);
  int number = 0;
  for (const auto& [node, what] :
       {std::pair{"h2", "last peak"}, {"r", "reference"}, {"hl", "least stroke"}}) {
    // The second diode keeps an op-amp that is not the greatest a diode's voltage below its input, out of saturation.
    const std::string end = fmt::format("ep{}", ++number), minus = fmt::format("np{}", number);
    const std::string role = fmt::format("stroke, greatest: {}", what);
    const int greatest = opamp(role, node, minus, end);
    if (number == 1) out_.stroke->follow.push_back(greatest);
    diode(fmt::format("Dp{}a", number), role, end, "al");
    diode(fmt::format("Dp{}b", number), role, minus, end);
    resistor(fmt::format("Rq{}p", number), role, "al", minus, kDividerOhm,
             options_.resistors.nearest(kDividerOhm));
  }
  resistor("Rp3", "stroke, draws what no diode gives", "al", "0", 10e3);
  out_.stroke->inverter = invert("stroke", "al", "an");
}

/// An op-amp whose feedback goes through a multiplier: alpha z/U = k V(node), so that z = k U V(node)/alpha.
std::string Builder::over_stroke(const std::string& node) {
  if (!out_.stroke) return node;
  const std::string quotient = "z" + node, plus = "pz" + node, product = "y" + node;
  if (out_.stroke->divisions.contains(node)) return quotient;
  const std::size_t back = group;
  enter("division by the stroke", Purpose::division);
  const double u = out_.multiplier.scale_v;
  // The pair whose ratio is next below what uses the multiplier's range.
  const double scale = kRoom * out_.multiplier.greatest_input_v / top(), ratio = scale / u;
  const double lower = options_.resistors.nearest(kDividerOhm);
  const int above =
      resistor("Rz1" + node, "divided by the stroke, " + node, node, plus, lower * (1.0 / ratio - 1.0));
  const int below = resistor("Rz2" + node, "divided by the stroke, " + node, plus, "0", lower, lower);
  out_.stroke->argument_scale =
      u * out_.part(below).realised / (out_.part(below).realised + out_.part(above).realised);
  const int divides = opamp("divides by the stroke, " + node, plus, product, quotient);
  const int back_product = multiplier("Mz" + node, "stroke times quotient, " + node, quotient, "al", "0",
                                      product, top() * scale / u);
  out_.stroke->divisions[node] = {above, below, divides, back_product};
  group = back;
  return quotient;
}

void Builder::amplitude_gains() {
  GainCurve curve = GainCurve::over_amplitude();
  curve.corner_v = strokes();
  for (const double alpha : curve.corner_v)
    curve.corner_text.push_back(fmt::format("corner at {} of the stroke", rounded_text(alpha, 4)));
  for (std::size_t b = 0; b < out_.branches.size(); ++b) curve.gain.push_back(stroke_gains(b));
  if (is_open()) {
    out_.amplitude->wanted = curve.gain;
    enter("amplitude curve", Purpose::amplitude);
    invert("stroke", "amplitude", "an");
  }
  build_curve(curve, gains(&Branch::amplitude));
}

}  // namespace bodesmith::generator
