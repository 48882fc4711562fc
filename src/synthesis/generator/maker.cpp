#include "synthesis/generator/maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::generator {
namespace {

using schematic::Purpose;

/// A threshold takes a resistor of at most so many times the rectifier's own.
constexpr double kReferenceRatio = 50.0;

/// "x^2/U", "x^3/U^2"
std::string power_over_scale(int power) {
  return power_text(power) + (power == 2 ? "/U" : fmt::format("/U^{}", power - 1));
}

/// The two powers that make x^k: both there already if possible, otherwise as equal as possible (short chains).
std::pair<int, int> factors(int k, const std::vector<bool>& needed) {
  const auto there = [&](int power) { return power == 1 || needed[static_cast<std::size_t>(power)]; };
  for (int a = (k + 1) / 2; a < k; ++a) {
    if (there(a) && there(k - a)) return {a, k - a};
  }
  return {(k + 1) / 2, k / 2};
}

/// Gains on the rectifiers' nodes and, last, on the reference that make U (K/K0 - direct): each corner's change of slope, the
/// last corner's gain.
std::vector<double> control_gains(const GainCurve& curve, const std::vector<double>& k,
                                  const BranchGain& gain, double scale_v) {
  const std::size_t n = k.size();
  const double per_gain = scale_v / gain.at_rest;
  const auto slope = [&](std::size_t i) {  // of the piece that ends at corner i, V per V of the curve's node
    if (i == 0 || i >= n) return 0.0;
    return per_gain * (k[i] - k[i - 1]) / (curve.corner_v[i] - curve.corner_v[i - 1]);
  };
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(slope(i) - slope(i + 1));
  out.push_back((per_gain * k.back() - gain.direct * scale_v) / kReferenceV);
  return out;
}

}  // namespace

std::string power_text(int power) {
  return power == 1 ? "x" : fmt::format("x^{}", power);
}

std::string branch_letter(std::size_t branch, std::size_t count) {
  if (count == 1) return "";
  if (count == 2) return branch == 0 ? "a" : "d";
  return fmt::format("{}_", branch + 1);
}

BranchGain BranchGain::between(double least, double most, const schematic::MultiplierModel& multiplier) {
  const double u = multiplier.scale_v, range = multiplier.greatest_input_v;
  if (least > 0.0 && u * (most - least) / (most + least) <= range) return {.at_rest = 0.5 * (least + most)};
  return {.at_rest = std::max(std::abs(least), std::abs(most)) * u / (kRoom * range), .direct = 0.0};
}

GainCurve GainCurve::over_rate() {
  return {"rate", Purpose::rate_curve, Purpose::rate_gain, "sn", "k", "c", "n", "M", "g"};
}

GainCurve GainCurve::over_amplitude() {
  return {"amplitude", Purpose::amplitude, Purpose::amplitude, "an", "q", "h", "i", "Mh", "j"};
}

bool GainCurve::varies(std::size_t branch) const {
  const auto [least, most] = std::minmax_element(gain[branch].begin(), gain[branch].end());
  return *least != *most;
}

double Powers::level(int power, const schematic::MultiplierModel& multiplier) const {
  return power == 1 ? first : multiplier.scale_v * std::pow(scale / multiplier.scale_v, power);
}

void GeneratorMaker::enter(const std::string& title, Purpose purpose) {
  const auto at = std::ranges::find(to_.groups, title, &schematic::Group::title);
  group =
      at == to_.groups.end() ? add_group(title, purpose) : static_cast<std::size_t>(at - to_.groups.begin());
}

int GeneratorMaker::multiplier(const std::string& name, const std::string& role, const std::string& x,
                               const std::string& y, const std::string& z, const std::string& to,
                               double peak_v) {
  if (peak_v > to_.multiplier.greatest_output_v) {
    throw DesignError(fmt::format("{} ({}) reaches {} V, expected at most the {}'s {} V", name, role,
                                  rounded_text(peak_v), to_.multiplier.name,
                                  rounded_text(to_.multiplier.greatest_output_v)));
  }
  to_.multipliers.push_back({name, role, group, x, y, z, to, peak_v});
  return static_cast<int>(to_.multipliers.size()) - 1;
}

void GeneratorMaker::make_powers(Powers& powers, std::vector<bool> needed, double top) {
  const auto most = static_cast<int>(needed.size()) - 1;
  for (int k = most; k >= 2; --k) {
    if (!needed[static_cast<std::size_t>(k)]) continue;
    const auto [a, b] = factors(k, needed);
    needed[static_cast<std::size_t>(a)] = needed[static_cast<std::size_t>(b)] = true;
  }
  const auto read = [&](int power) { return power == 1 ? powers.scaled : powers.node(power); };
  for (int k = 2; k <= most; ++k) {
    if (!needed[static_cast<std::size_t>(k)]) continue;
    const auto [a, b] = factors(k, needed);
    powers.multipliers.push_back(multiplier(fmt::format("M{}{}", k, powers.tail), power_over_scale(k),
                                            read(a), read(b), "0", powers.node(k),
                                            powers.level(k, to_.multiplier) * std::pow(top, k)));
  }
}

GeneratorMaker::WeightedSum GeneratorMaker::weighted_sum(const Powers& powers, const std::vector<double>& a,
                                                         double volts, std::size_t branch,
                                                         const std::string& node, int power,
                                                         const std::string& suffix) {
  const std::string of = letter(branch), tail = powers.tail + suffix;
  std::vector<double> gains, level;
  std::vector<Weight> weights;
  for (int k = 0; k < static_cast<int>(a.size()); ++k) {
    level.push_back(powers.level(k + 1, to_.multiplier));
    gains.push_back(volts * a[static_cast<std::size_t>(k)] / level.back());
    weights.push_back({powers.node(k + 1), fmt::format("R{}{}{}", of, power + k, powers.tail),
                       fmt::format("weight of {}, {}", power_text(power + k), name(branch))});
  }
  constexpr int kPoints = 24;
  std::vector<std::vector<double>> rows;
  for (int i = 1; i <= kPoints; ++i) {
    std::vector<double>& row = rows.emplace_back();
    double wanted = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      row.push_back(level[k] * std::pow(static_cast<double>(i) / kPoints, k + 1));
      wanted += gains[k] * row.back();
    }
    row.push_back(wanted);
  }
  const synthesis::SummingDesign design =
      synthesis::search_sum(gains, rows, resistors_, "sum of the powers, " + name(branch));
  const Sum made = sum(weights, gains, design, "R" + of, tail, name(branch),
                       "sum of the powers, " + name(branch), "p" + of + tail, "m" + of + tail, node);
  WeightedSum out{made.opamp, made.noise_gain, {}};
  for (std::size_t k = 0; k < a.size(); ++k)
    out.realised.push_back(gains[k] == 0.0 ? 0.0 : design.gains[k] * level[k] / volts);
  return out;
}

GeneratorMaker::Inverter GeneratorMaker::invert(const std::string& role, const std::string& from,
                                                const std::string& to) {
  const double ohm = resistors_.nearest(10e3);
  Inverter out;
  out.input = resistor("Rp4", role + ", inverted", from, "mp", 10e3, ohm);
  out.feedback = resistor("Rp5", role + ", inverted, feedback", "mp", to, 10e3, ohm);
  out.opamp = opamp(role + ", inverted", "0", "mp", to);
  return out;
}

void GeneratorMaker::reference() {
  if (to_.sources.empty())
    to_.sources.push_back({"Vref", "ADR4525 (2.5 V)", "vr", kReferenceV, add_group("", Purpose::rate_curve)});
}

/// One rectifier a corner: -max(0, s_k - s). They rest above their corner, so that beyond the last one the gain is held.
void GeneratorMaker::build_curve(const GainCurve& curve, const std::vector<BranchGain*>& gains) {
  reference();
  enter(curve.what + " curve", curve.corners);
  double low_v = kReferenceV;
  std::string low_reference = "vr";
  if (const double least = curve.corner_v.front(); least < kReferenceV / kReferenceRatio) {
    low_reference = "vl";
    const double wanted = std::clamp(25.0 * least, 1e-3, 0.25), lower = 100.0;
    const int up = resistor("Rl1", "low reference", "vr", "vm", lower * (kReferenceV / wanted - 1.0));
    const int down = resistor("Rl2", "low reference", "vm", "0", lower);
    opamp("low reference", "vm", "vl", "vl");
    low_v = kReferenceV * to_.part(down).realised / (to_.part(down).realised + to_.part(up).realised);
  }
  for (std::size_t k = 0; k < curve.corner_v.size(); ++k) {
    const bool low = curve.corner_v[k] < kReferenceV / kReferenceRatio;
    rectifier(curve.rectifier(k), curve.corner_text[k], curve.node, low ? low_reference : "vr",
              (low ? low_v : kReferenceV) / curve.corner_v[k]);
  }
  for (std::size_t b = 0; b < gains.size(); ++b) {
    if (curve.varies(b)) gains[b]->control = control(curve, b, *gains[b]);
  }
}

/// Control voltage of a branch. It counts at the corners, the middles between them, and below the first corner, where the gain
/// must rest.
int GeneratorMaker::control(const GainCurve& curve, std::size_t branch, const BranchGain& gain) {
  enter(fmt::format("{} gain, {}", curve.what, name(branch)), curve.of);
  const std::vector<double> gains = control_gains(curve, curve.gain[branch], gain, to_.multiplier.scale_v);
  const std::vector<double>& corner = curve.corner_v;
  std::vector<double> at = {0.0, 0.5 * corner[0]};
  std::vector<std::string> from;
  for (std::size_t i = 0; i < corner.size(); ++i) {
    from.push_back(curve.rectifier(i));
    at.push_back(corner[i]);
    if (i + 1 < corner.size()) at.push_back(std::sqrt(corner[i] * corner[i + 1]));
  }
  from.emplace_back("vr");
  std::vector<std::vector<double>> rows;
  for (const double s : at) {
    std::vector<double> row;
    for (const double one : corner) row.push_back(-std::max(0.0, one - s));
    row.push_back(kReferenceV);
    double wanted = 0.0;
    for (std::size_t i = 0; i < gains.size(); ++i) wanted += gains[i] * row[i];
    row.push_back(wanted);
    rows.push_back(std::move(row));
  }
  try {
    return signed_sum(from, gains, rows, fmt::format("{} control voltage, {}", curve.what, name(branch)),
                      curve.control + letter(branch), curve.inverted + letter(branch));
  } catch (const DesignError& error) {
    throw TooSteep(fmt::format("{}: the table's gains change too steeply", error.what()));
  }
}

std::string GeneratorMaker::vary(const GainCurve& curve, const BranchGain& gain, std::size_t branch,
                                 const std::string& node, const std::string& tail, double peak_v) {
  if (gain.control < 0) return node;
  const std::string to = curve.gained + letter(branch) + tail;
  multiplier(curve.multiplier + letter(branch) + tail, fmt::format("{} gain, {}", curve.what, name(branch)),
             node, curve.control + letter(branch), gain.direct != 0.0 ? node : "0", to, peak_v);
  return to;
}

void GeneratorMaker::slope_sign(const std::string& input, double stroke, Hertz lowest) {
  enter("slope's sign", Purpose::slope_sign);
  // The slowest triangle makes 100 mV at Rd.
  const double product = 0.1 / (2.0 * lowest.value * stroke), rd = std::max(470e3, product / 1e-6);
  const double cd = capacitors_.nearest(std::max(product / rd, 1e-9));
  resistor("Rs", "slope's sign, damping", input, "sa", 0.33e-6 / cd);
  capacitor("Cd", "slope's sign, differentiates", "sa", "sb", cd);
  resistor("Rd", "slope's sign, gain for slow signals", "sb", "sc", rd);
  capacitor("Cf", "slope's sign, damping", "sb", "sc", 3.3e-4 * cd);
  diode("D1", "slope's sign, limit", "sb", "sc");
  diode("D2", "slope's sign, limit", "sc", "sb");
  resistor("Rh1", "slope's sign, hysteresis", "sp", "0", 1e3);
  resistor("Rh2", "slope's sign, hysteresis", "so", "sp", to_.other_opamps.at(0).swing_v / 0.02 * 1e3);
  for (const int one : {opamp("slope's sign, differentiator", "0", "sb", "sc"),
                        opamp("slope's sign, comparator", "sp", "sc", "so")})
    to_.opamps[static_cast<std::size_t>(one)].type = 1;
}

void arrange(schematic::Netlist& netlist) {
  static constexpr Purpose kOrder[] = {Purpose::slope_sign, Purpose::slope_meter,  Purpose::rate_curve,
                                       Purpose::rate_gain,  Purpose::stroke,       Purpose::division,
                                       Purpose::amplitude,  Purpose::output,       Purpose::branch,
                                       Purpose::powers,     Purpose::branch_switch};
  schematic::sort_groups(netlist, [](Purpose a, Purpose b) {
    return std::find(std::begin(kOrder), std::end(kOrder), a) <
           std::find(std::begin(kOrder), std::end(kOrder), b);
  });
}

}  // namespace bodesmith::generator
