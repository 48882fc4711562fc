#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "numeric/interpolated.hpp"
#include "synthesis/generator/build.hpp"

namespace bodesmith::generator {
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
  std::ranges::sort(inside);
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
    for (std::size_t b = 0; b < 2; ++b) {
      const std::vector<double>& k = disturbance.rate.of(kBranches[b]);
      rise = std::max(rise, 100.0 * peak[b] * std::abs(k[i] - k[i - 1]) / std::log(high / low));
    }
    std::size_t pieces = 1;
    while (pieces < kMostPieces &&
           rise * chord_error(std::pow(high / low, 1.0 / static_cast<double>(pieces))) > tolerance_percent)
      ++pieces;
    add_inside(low, high, pieces, tracked, out.corner);
    out.corner.push_back(table[i]);
  }
  for (std::size_t b = 0; b < 2; ++b) {
    const auto which = kBranches[b];
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
constexpr double kRectifierOhm = 10e3;

}  // namespace

double RateCurve::value(Disturbance::Branch which, Hertz frequency) const {
  return interpolated(hertz_values(corner), gain[branch_index(which)], frequency.value);
}

/// w = -Rd Cd dr/dt, then -|w| with a first-order smoothing: sn.
void Builder::slope_meter() {
  const std::string r = over_stroke("r");
  enter("slope", Purpose::slope_meter);
  DisturbanceCircuit::SlopeMeter m;
  const double last = out_.disturbance.rate.frequency.back().value,
               first = out_.disturbance.rate.frequency.front().value;
  const double full_v = last / first > kWideTable ? kWideSlopeV : kFullSlopeV;
  const double product = std::min(full_v / (2.0 * last * out_.reference_stroke), 0.4);
  const double cd = options_.capacitors.nearest(std::clamp(product / 50e3, 100e-12, 220e-9));
  // The op-amp's own limit, sqrt(GBW/(2 pi Rd Cd)), with both time constants there: no ringing.
  const double crossing = std::sqrt(out_.opamp.gain_bandwidth.value / (2.0 * std::numbers::pi * product));
  const double lag = 1.2 / (2.0 * std::numbers::pi * crossing);
  m.damping = resistor("Rw1", "slope, damping", r, "wa", lag / cd);
  m.differentiates = capacitor("Cw1", "slope, differentiates", "wa", "wb", cd);
  m.gain = resistor("Rw2", "slope, gain", "wb", "w0", product / cd);
  m.limits = capacitor("Cw2", "slope, damping", "wb", "w0", std::max(lag * cd / product, 1e-12));
  m.opamp = opamp("slope, differentiator", "0", "wb", "w0");
  m.volts_per_hz = 2.0 * out_.reference_stroke * (out_.stroke ? out_.stroke->argument_scale : 1.0) *
                   out_.part(m.gain).realised * out_.part(m.differentiates).realised;

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

/// Straight pieces over the slope meter's voltage: beyond the last corner the gain is held whatever the slope.
void Builder::rate_gains() {
  if (!options_.rates || out_.disturbance.rate.frequency.empty() ||
      (gain_limit(0, true) == gain_limit(0, false) && gain_limit(1, true) == gain_limit(1, false)))
    return;
  slope_meter();
  double peak[2];
  for (std::size_t b = 0; b < 2; ++b) peak[b] = peak_of(b) * out_.branches[b].greatest_amplitude;
  out_.curve = make_rate_curve(out_.disturbance, peak, options_.tracked, options_.rate_tolerance_percent);
  GainCurve curve = GainCurve::over_rate();
  for (const Hertz f : out_.curve->corner) {
    curve.corner_v.push_back(f.value * out_.slope->volts_per_hz);
    curve.corner_text.push_back(fmt::format("corner at {} Hz", rounded_text(f.value)));
  }
  curve.gain = {out_.curve->gain[0], out_.curve->gain[1]};
  build_curve(curve, gains(&Branch::rate));
}

}  // namespace bodesmith::generator
