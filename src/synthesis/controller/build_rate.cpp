#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/controller/build.hpp"
#include "synthesis/controller/controller.hpp"
#include "synthesis/controller/sum_search.hpp"

namespace bodesmith::controller {
namespace {

constexpr std::size_t kMostPieces = 12;  // to an interval of the table
constexpr int kCheckPoints = 24;         // to a piece

/// Greatest distance of the chord over a ratio of frequencies from ln f, for a rise of 1 in ln f.
double chord_error(double ratio) {
  const double h = std::log(ratio) / (ratio - 1.0);
  return h - 1.0 - std::log(h);
}

/// Corners strictly inside (low, high): the tracked frequencies when they are enough, otherwise equal ratios.
void add_inside(double low, double high, std::size_t pieces, const std::vector<Hertz>& tracked,
                std::vector<Hertz>& out) {
  std::vector<double> inside;
  for (const Hertz f : tracked) {
    if (f.value > low * 1.02 && f.value < high / 1.02) inside.push_back(f.value);
  }
  std::sort(inside.begin(), inside.end());
  if (inside.size() + 1 == pieces) {
    for (const double f : inside) out.push_back(Hertz{f});
    return;
  }
  for (std::size_t i = 1; i < pieces; ++i) {
    out.push_back(Hertz{low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(pieces))});
  }
}

/// Between two frequencies of the table the gain is linear in ln f; straight pieces over f take its place, as
/// many as keep |K - table| |d| below the tolerance (percent of range). `peak`: greatest |d| of the branches.
RateCurve make_rate_curve(const Disturbance& disturbance, const double peak[2],
                          const std::vector<Hertz>& tracked, double tolerance_percent) {
  const std::vector<Hertz>& table = disturbance.rate.frequency;
  RateCurve out;
  out.corner.push_back(table.front());
  for (std::size_t i = 1; i < table.size(); ++i) {
    const double low = table[i - 1].value, high = table[i].value;
    double rise = 0.0;  // percent of range for one unit of ln f
    for (const int b : {0, 1}) {
      const std::vector<double>& k = b == 0 ? disturbance.rate.ascending : disturbance.rate.descending;
      rise = std::max(rise, 100.0 * peak[b] * std::abs(k[i] - k[i - 1]) / std::log(high / low));
    }
    std::size_t pieces = 1;
    while (pieces < kMostPieces &&
           rise * chord_error(std::pow(high / low, 1.0 / static_cast<double>(pieces))) > tolerance_percent)
      ++pieces;
    add_inside(low, high, pieces, tracked, out.corner);
    out.corner.push_back(table[i]);
  }
  for (const int b : {0, 1}) {
    const auto which = b == 0 ? Disturbance::Branch::ascending : Disturbance::Branch::descending;
    for (const Hertz f : out.corner) out.gain[b].push_back(disturbance.rate_gain(which, f));
    for (std::size_t i = 1; i < out.corner.size(); ++i) {
      const double ratio = out.corner[i].value / out.corner[i - 1].value;
      for (int j = 1; j < kCheckPoints; ++j) {
        const Hertz f{out.corner[i - 1].value * std::pow(ratio, static_cast<double>(j) / kCheckPoints)};
        out.max_error =
            std::max(out.max_error, std::abs(out.value(which, f) - disturbance.rate_gain(which, f)));
      }
    }
  }
  return out;
}

/// Of the slope meter at the table's highest frequency.
constexpr double kFullSlopeV = 1.0;
/// Tables that span more than this have a higher full slope: the lowest thresholds stand clear of offsets.
constexpr double kWideTable = 300.0, kWideSlopeV = 4.0;
constexpr double kReferenceV = 2.5;
/// A threshold takes a resistor of at most so many times the rectifier's own.
constexpr double kReferenceRatio = 50.0;
constexpr double kRectifierOhm = 10e3;

std::string rectifier_node(std::size_t corner) {
  return fmt::format("k{}", corner + 1);
}

}  // namespace

double RateCurve::value(Disturbance::Branch which, Hertz frequency) const {
  const std::vector<double>& k = gain[which == Disturbance::Branch::ascending ? 0 : 1];
  if (frequency.value <= corner.front().value) return k.front();
  for (std::size_t i = 1; i < corner.size(); ++i) {
    if (frequency.value > corner[i].value) continue;
    const double t = (frequency.value - corner[i - 1].value) / (corner[i].value - corner[i - 1].value);
    return k[i - 1] + t * (k[i] - k[i - 1]);
  }
  return k.back();
}

/// Differentiator with a logarithmic limit (two diodes across Rd) and a comparator with hysteresis, as in
/// multiplier_layout. How late the sign is: sqrt(dV/(2 pi GBW ds)), dV the diodes' voltage and ds the slope, at
/// least; hence the faster op-amp, and ten times that detector's current against the junctions' charge.
void Builder::detector() {
  enter("slope's sign");
  const double rd = 470e3;
  // The slowest full-stroke triangle makes 100 mV at Rd.
  const double cd = options_.capacitors.nearest(
      std::clamp(0.1 / (2.0 * options_.lowest.value * options_.reference_stroke * rd), 1e-9, 1e-6));
  resistor("Rs", "slope's sign, damping", "r", "sa", 0.33e-6 / cd);
  capacitor("Cd", "slope's sign, differentiates", "sa", "sb", cd);
  resistor("Rd", "slope's sign, gain for slow signals", "sb", "sc", rd);
  capacitor("Cf", "slope's sign, damping", "sb", "sc", 3.3e-4 * cd);
  diode("D1", "slope's sign, limit", "sb", "sc");
  diode("D2", "slope's sign, limit", "sc", "sb");
  resistor("Rh1", "slope's sign, hysteresis", "sp", "0", 1e3);
  resistor("Rh2", "slope's sign, hysteresis", "so", "sp", out_.fast_opamp.swing_v / 0.02 * 1e3);
  opamp("slope's sign, differentiator", "0", "sb", "sc");
  opamp("slope's sign, comparator", "sp", "sc", "so");
  for (schematic::OpAmp& one : out_.opamps) one.fast = true;
}

/// w = -Rd Cd dr/dt, then -|w| with a first-order smoothing: sn.
void Builder::slope_meter() {
  enter("slope");
  AnalogController::SlopeMeter m;
  const double last = disturbance_.rate.frequency.back().value,
               first = disturbance_.rate.frequency.front().value;
  const double full_v = last / first > kWideTable ? kWideSlopeV : kFullSlopeV;
  const double product = std::min(full_v / (2.0 * last * options_.reference_stroke), 0.4);
  const double cd = options_.capacitors.nearest(std::clamp(product / 50e3, 100e-12, 220e-9));
  // The op-amp's own limit, sqrt(GBW/(2 pi Rd Cd)), with both time constants there: no ringing.
  const double crossing = std::sqrt(out_.opamp.gain_bandwidth.value / (2.0 * std::numbers::pi * product));
  const double lag = 1.2 / (2.0 * std::numbers::pi * crossing);
  m.damping = resistor("Rw1", "slope, damping", "r", "wa", lag / cd);
  m.differentiates = capacitor("Cw1", "slope, differentiates", "wa", "wb", cd);
  m.gain = resistor("Rw2", "slope, gain", "wb", "w0", product / cd);
  m.limits = capacitor("Cw2", "slope, damping", "wb", "w0", std::max(lag * cd / product, 1e-12));
  m.opamp = opamp("slope, differentiator", "0", "wb", "w0");
  m.volts_per_hz =
      2.0 * options_.reference_stroke * out_.part(m.gain).realised * out_.part(m.differentiates).realised;

  m.half_wave_input = resistor("Rw3", "half-wave rectifier, input", "w0", "wm", kRectifierOhm);
  m.half_wave_feedback = resistor("Rw4", "half-wave rectifier, feedback", "wm", "wh", kRectifierOhm);
  diode("Dw1", "half-wave rectifier", "we", "wh");
  diode("Dw2", "half-wave rectifier", "wm", "we");
  m.half_wave_opamp = opamp("half-wave rectifier", "0", "wm", "we");

  const double twice = 2.0 * kRectifierOhm;
  m.direct = resistor("Rw5", "full-wave rectifier, slope", "w0", "wn", twice);
  m.half = resistor("Rw6", "full-wave rectifier, half wave", "wh", "wn", kRectifierOhm);
  m.full_wave_feedback = resistor("Rw7", "full-wave rectifier, feedback", "wn", "sn", twice);
  m.smoothing_s = options_.averaging_s > 0.0 ? options_.averaging_s : 0.01 / last;
  m.smoothing = capacitor("Cw3", "full-wave rectifier, smoothing", "wn", "sn", m.smoothing_s / twice);
  m.smoothing_s = out_.part(m.smoothing).realised * out_.part(m.full_wave_feedback).realised;
  m.full_wave_opamp = opamp("full-wave rectifier", "0", "wn", "sn");
  out_.slope = std::move(m);
}

/// One rectifier a corner of the gain curve: -max(0, s_k - s). They rest above their corner, so that beyond
/// the last one the gain is held whatever the slope.
void Builder::curve_rectifiers() {
  enter("rate curve");
  double peak[2];
  for (const int b : {0, 1}) peak[b] = peak_of(b);
  out_.curve = make_rate_curve(disturbance_, peak, options_.tracked, options_.rate_tolerance_percent);
  const double least = out_.curve->corner.front().value * out_.slope->volts_per_hz;
  out_.sources.push_back({"Vref", "ADR4525 (2.5 V)", "vr", kReferenceV});
  double low_v = kReferenceV;
  std::string low_reference = "vr";
  if (least < kReferenceV / kReferenceRatio) {
    low_reference = "vl";
    const double wanted = std::clamp(25.0 * least, 1e-3, 0.25), lower = 100.0;
    const int up = resistor("Rl1", "low reference", "vr", "vm", lower * (kReferenceV / wanted - 1.0));
    const int down = resistor("Rl2", "low reference", "vm", "0", lower);
    opamp("low reference", "vm", "vl", "vl");
    low_v = kReferenceV * out_.part(down).realised / (out_.part(down).realised + out_.part(up).realised);
  }
  for (std::size_t k = 0; k < out_.curve->corner.size(); ++k) {
    const double threshold = out_.curve->corner[k].value * out_.slope->volts_per_hz;
    const bool low = threshold < kReferenceV / kReferenceRatio;
    rectifier(k, threshold, low ? low_reference : "vr", low ? low_v : kReferenceV);
  }
}

void Builder::rectifier(std::size_t k, double threshold_v, const std::string& reference, double reference_v) {
  // Input and feedback are equal; of a decade of them the one whose reference resistor is nearest the series.
  double input = options_.resistors.nearest(kRectifierOhm), best = 1.0;
  if (!options_.resistors.is_exact()) {
    for (const double r : options_.resistors.values(kRectifierOhm, 2.2 * kRectifierOhm)) {
      const double other = options_.resistors.nearest(r * reference_v / threshold_v);
      const double off = std::abs(r * reference_v / other / threshold_v - 1.0);
      if (off < best) {
        best = off;
        input = r;
      }
    }
  }
  const std::string node = rectifier_node(k), minus = "m" + node, end = "e" + node;
  const std::string role = fmt::format("corner at {} Hz", rounded_text(out_.curve->corner[k].value));
  const std::string number = fmt::format("{}", k + 1);
  resistor("Rk" + number + "i", role + ", slope", "sn", minus, input, input);
  resistor("Rk" + number + "r", role + ", threshold", reference, minus, input * reference_v / threshold_v);
  resistor("Rk" + number + "f", role + ", feedback", minus, node, input, input);
  diode("Dk" + number + "a", role, node, end);
  diode("Dk" + number + "b", role, end, minus);
  opamp(role, "0", minus, end);
}

/// Gains on the rectifiers' nodes and, last, on the reference that make U (K/K0 - 1): each corner's change of
/// slope, the last frequency's gain.
std::vector<double> Builder::control_gains(int b) const {
  const RateCurve& curve = *out_.curve;
  const std::vector<double>& k = curve.gain[b];
  const std::size_t n = curve.corner.size();
  const double per_gain = out_.multiplier.scale_v / out_.rate[b].at_rest, s = out_.slope->volts_per_hz;
  const auto slope = [&](std::size_t i) {  // of the piece that ends at corner i, V per V of the slope meter
    if (i == 0 || i >= n) return 0.0;
    return per_gain * (k[i] - k[i - 1]) / ((curve.corner[i].value - curve.corner[i - 1].value) * s);
  };
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(slope(i) - slope(i + 1));
  out.push_back((per_gain * k.back() - out_.multiplier.scale_v) / kReferenceV);
  return out;
}

/// Voltages of the rectifiers and the reference at the corners, the middles between them, and below the first
/// corner, where the gain must rest.
std::vector<std::vector<double>> Builder::control_rows() const {
  const std::vector<Hertz>& corner = out_.curve->corner;
  std::vector<double> at = {0.0, 0.5 * corner[0].value};
  for (std::size_t i = 0; i < corner.size(); ++i) {
    at.push_back(corner[i].value);
    if (i + 1 < corner.size()) at.push_back(std::sqrt(corner[i].value * corner[i + 1].value));
  }
  std::vector<std::vector<double>> rows;
  for (const double f : at) {
    std::vector<double> row;
    for (const Hertz one : corner) row.push_back(-std::max(0.0, (one.value - f) * out_.slope->volts_per_hz));
    row.push_back(kReferenceV);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// One inverting sum of the control voltage; a rectifier that rests has its feedback's resistance only, so
/// that its node must end at a virtual ground.
int Builder::inverting_sum(const std::vector<std::string>& from, const std::vector<double>& gains,
                           const std::vector<std::vector<double>>& rows, const std::string& letters,
                           const std::string& role, const std::string& node, std::vector<double>& realised) {
  const SumDesign design = search_sum(gains, rows, options_.resistors, 2e-5, role);
  const std::string minus = "m" + node;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (design.realised[i] == 0.0) continue;
    resistor(fmt::format("R{}{}", letters, i + 1), role + " from " + from[i], from[i], minus,
             design.wanted[i], design.realised[i]);
  }
  resistor("R" + letters + "f", role + ", feedback", minus, node, design.feedback, design.feedback);
  realised = design.gains;
  return opamp(role, "0", minus, node);
}

/// Control voltage of a branch. What enters with a positive gain passes an inverting sum of its own first.
void Builder::control(int b) {
  if (gain_limit(b, true) == gain_limit(b, false)) return;
  const std::string name = b == 0 ? "ascending" : "descending", letter = b == 0 ? "a" : "d";
  enter("rate gain, " + name);
  const std::vector<double> gains = control_gains(b);
  const std::vector<std::vector<double>> voltages = control_rows();
  std::vector<std::string> from[2];  // inverted once, inverted twice
  std::vector<double> gain[2];
  std::vector<std::vector<double>> rows[2];
  for (int side : {0, 1}) rows[side].resize(voltages.size());
  std::vector<double> total(voltages.size(), 0.0), twice(voltages.size(), 0.0);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const std::size_t side = gains[i] > 0.0 ? 1 : 0;
    from[side].push_back(i + 1 < gains.size() ? rectifier_node(i) : "vr");
    gain[side].push_back(-std::abs(gains[i]));
    for (std::size_t row = 0; row < voltages.size(); ++row) {
      rows[side][row].push_back(voltages[row][i]);
      total[row] += gains[i] * voltages[row][i];
      if (side == 1) twice[row] -= gains[i] * voltages[row][i];
    }
  }
  std::vector<double> realised;
  if (!from[1].empty()) {
    for (std::size_t row = 0; row < voltages.size(); ++row) rows[1][row].push_back(twice[row]);
    inverting_sum(from[1], gain[1], rows[1], "n" + letter, "control voltage, inverted, " + name, "n" + letter,
                  realised);
    from[0].push_back("n" + letter);
    gain[0].push_back(-1.0);
    for (std::size_t row = 0; row < voltages.size(); ++row) {
      double got = 0.0;
      for (std::size_t k = 0; k < realised.size(); ++k) got += realised[k] * rows[1][row][k];
      rows[0][row].push_back(got);
    }
  }
  for (std::size_t row = 0; row < voltages.size(); ++row) rows[0][row].push_back(total[row]);
  out_.rate[b].control = inverting_sum(from[0], gain[0], rows[0], "c" + letter, "control voltage, " + name,
                                       "c" + letter, realised);
}

}  // namespace bodesmith::controller
