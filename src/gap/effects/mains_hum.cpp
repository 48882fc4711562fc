#include <algorithm>
#include <cmath>
#include <complex>

#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "numeric/fourier.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// The grid keeps to its nominal frequency within this part.
constexpr double kTolerance = 0.005;
constexpr int kHarmonics = 7;
/// Fewer cycles in the record, as sampled, are a drift or an offset to it, and lines nearer to each other one line.
constexpr double kMinCycles = 2.0;

/// Where a frequency comes to lie when sampled.
double alias_of(double hz, double rate_hz) {
  return std::abs(hz - rate_hz * std::round(hz / rate_hz));
}

struct Line {
  double nominal_hz = 0.0;
  double hz = 0.0;
  double amplitude = 0.0;  ///< of any unit
};

/// Of each harmonic of either mains the largest line within the grid's tolerance of it; the lower harmonic first.
std::vector<Line> lines_of(const Scene& scene) {
  const double rate_hz = 1.0 / scene.step_s;
  // Without its drift, and fine enough for lines between the record's own frequencies.
  auto padded = less_straight_line(scene.residual);
  padded.resize(smooth_length(2 * padded.size()), 0.0);
  const auto bins = half_spectrum(padded);
  const double bin_hz = rate_hz / static_cast<double>(padded.size());
  std::vector<Line> lines;
  for (int harmonic = 1; harmonic <= kHarmonics; ++harmonic) {
    for (const double mains : {50.0, 60.0}) {
      const double nominal_hz = mains * harmonic;
      const double seen = alias_of(nominal_hz, rate_hz);
      if (std::min(seen, 0.5 * rate_hz - seen) * scene.duration_s < kMinCycles) continue;
      Line& best = lines.emplace_back(Line{nominal_hz, nominal_hz, -1.0});
      const int count = whole_number<int>(std::floor(kTolerance * nominal_hz / bin_hz));
      for (int k = -count; k <= count; ++k) {
        const double hz = nominal_hz + bin_hz * k;
        const auto bin = whole_number<std::size_t>(alias_of(hz, rate_hz) / bin_hz + 0.5);
        const double amplitude = std::abs(bins[std::min(bin, bins.size() - 1)]);
        if (amplitude > best.amplitude) best = {nominal_hz, hz, amplitude};
      }
    }
  }
  return lines;
}

/// One line each, its frequency free within the grid's tolerance (above half the sampling rate it shows as
/// its alias), its size and phase each record's own.
void propose_mains_hum(const Scene& scene, std::vector<Proposal>& out) {
  auto lines = lines_of(scene);
  // Of harmonics that sampling folds to one place the lower one is likelier.
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Line& a, const Line& b) { return a.amplitude > b.amplitude; });
  const double rate = 1.0 / scene.step_s;
  const auto near = [&](const Line& a, const Line& b) {
    return std::abs(alias_of(a.hz, rate) - alias_of(b.hz, rate)) * scene.duration_s < kMinCycles;
  };
  for (const auto& line : best_apart(lines, near)) {
    const auto frequency = linear_unknown("frequency_hz", (1.0 - kTolerance) * line.nominal_hz,
                                          (1.0 + kTolerance) * line.nominal_hz, 0.1 / scene.duration_s);
    auto hum = chain::make_block("hum");
    hum.set("amplitude", 0.0).set("frequency_hz", line.hz).set("phase_deg", 0.0);
    out.push_back(insert_block(scene, scene.model->size(), hum, {frequency}, {{line.hz}}));
  }
}

}  // namespace

BODESMITH_EFFECT(mains_hum, .what = "a sinusoid of the mains is added",
                 .experiment = "a record without drive: hum stays", .repeatable = true,
                 .propose = propose_mains_hum)

}  // namespace bodesmith::gap
