#include <algorithm>
#include <cmath>
#include <complex>

#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// The grid keeps to its nominal frequency within this part.
constexpr double kTolerance = 0.005;
constexpr int kHarmonics = 7;
/// Fewer cycles in the record, as sampled, are a drift or an offset to it.
constexpr double kMinCycles = 2.0;
/// Frequencies that are looked at, in one of the record's resolution.
constexpr double kFiner = 3.0;

/// Where a frequency comes to lie when sampled.
double alias_of(double hz, double rate_hz) {
  return std::abs(hz - rate_hz * std::round(hz / rate_hz));
}

/// The residual's power at a frequency, of any unit.
double power_at(const Scene& scene, double hz) {
  const auto turn = std::polar(1.0, Hertz{hz}.rad_s().value * scene.step_s);
  std::complex<double> pointer = 1.0;
  std::complex<double> sum = 0.0;
  for (const double r : scene.residual) {
    sum += r * pointer;
    pointer *= turn;
  }
  return std::norm(sum);
}

/// Where within the grid's tolerance of a nominal frequency the residual has most.
double strongest_near(const Scene& scene, double nominal_hz) {
  const double spacing = 1.0 / (kFiner * scene.duration_s);
  const int count = whole_number<int>(std::floor(kTolerance * nominal_hz / spacing));
  double best = nominal_hz;
  double most = power_at(scene, best);
  for (int k = -count; k <= count; ++k) {
    const double hz = nominal_hz + spacing * k;
    if (const double power = power_at(scene, hz); power > most) {
      most = power;
      best = hz;
    }
  }
  return best;
}

class MainsHum final : public Effect {
 public:
  MainsHum()
      : Effect({.name = "mains_hum",
                .what = "a sinusoid of the mains is added",
                .experiment = "a record without drive: hum stays",
                .adds_one_signal = true,
                .repeatable = true}) {}
  /// One line each, its frequency free within the grid's tolerance (above half the sampling rate it shows as
  /// its alias), its size and phase each record's own.
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    const double rate = 1.0 / scene.step_s;
    std::vector<double> proposed;
    for (int harmonic = 1; harmonic <= kHarmonics; ++harmonic) {
      for (double mains : {50.0, 60.0}) {
        const double seen = alias_of(mains * harmonic, rate);
        if (std::min(seen, 0.5 * rate - seen) * scene.duration_s < kMinCycles) continue;
        const double hz = strongest_near(scene, mains * harmonic);
        const double line = alias_of(hz, rate);
        // Of harmonics that sampling folds to one place the lower one is likelier.
        if (std::any_of(proposed.begin(), proposed.end(),
                        [&](double other) { return std::abs(other - line) * scene.duration_s < 1.0; }))
          continue;
        proposed.push_back(line);
        out.push_back(with_line(scene, mains * harmonic, hz));
      }
    }
  }

 private:
  Proposal with_line(const Scene& scene, double nominal_hz, double hz) const {
    Model model = *scene.model;
    Term term;
    term.effect = this;
    term.placed = model.placed(model.size());
    const int id = model.insert(
        model.size(),
        chain::make_block("hum").set("amplitude", 0.0).set("frequency_hz", hz).set("phase_deg", 0.0));
    term.blocks = {id};
    term.lines = {id};
    auto frequency = linear_unknown("frequency_hz", (1.0 - kTolerance) * nominal_hz,
                                    (1.0 + kTolerance) * nominal_hz, 0.1 / scene.duration_s);
    term.unknowns = {frequency};
    term.write = [id](Model& m, std::span<const double> v) { m.block(id).set("frequency_hz", v[0]); };
    return propose_term(std::move(model), std::move(term), {{hz}});
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, mains_hum_effect, MainsHum)

}  // namespace bodesmith::gap
