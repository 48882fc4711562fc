#include <algorithm>
#include <cmath>
#include <complex>

#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/proposal.hpp"

namespace bodesmith::gap {
namespace {

/// The grid keeps to its nominal frequency within this part.
constexpr double kTolerance = 0.005;
constexpr int kHarmonics = 7;
/// Fewer cycles in the record, as sampled, are a drift or an offset to it.
constexpr double kMinCycles = 3.0;
/// Steps of the search for a line, in parts of the record's resolution.
constexpr double kStep = 0.2;
/// Blocks that stand for the record in a first look at so many neighbouring frequencies: the farthest of them turn by .035
/// rad from a block's middle to its ends, so that noise errs by some hundredths of its own size there. What comes within that
/// of the largest is looked at again.
constexpr std::size_t kBlocks = 730;
constexpr int kNeighbours = 80;
constexpr double kNearlyLargest = 0.9;
/// Lines of a harmonic's neighbourhood that are proposed, and how far apart they are (resolutions).
constexpr std::size_t kProposed = 2;
constexpr double kApart = 1.5;
constexpr double kDoubtAHarmonic = 0.03;

/// Where a frequency comes to lie when sampled.
double alias_of(double hz, double rate_hz) {
  return std::abs(hz - rate_hz * std::round(hz / rate_hz));
}

/// Amplitude of a line in the residual, roughly.
double amplitude_at(const Scene& scene, double hz) {
  const auto turn = std::polar(1.0, -Hertz{hz}.rad_s().value * scene.step_s);
  std::complex<double> pointer = 1.0;
  std::complex<double> sum = 0.0;
  for (double r : scene.residual) {
    sum += r * pointer;
    pointer *= turn;
  }
  return 2.0 * std::abs(sum) / static_cast<double>(scene.residual.size());
}

/// Sums over blocks of the residual, turned back by one frequency: near it a line's amplitude follows from these alone.
class BlockSums {
 public:
  BlockSums(const Scene& scene, double middle_hz)
      : samples_(std::max<std::size_t>(1, scene.residual.size() / kBlocks)),
        block_s_(scene.step_s * static_cast<double>(samples_)),
        scale_(2.0 / static_cast<double>(scene.residual.size())) {
    const auto turn = std::polar(1.0, -Hertz{middle_hz}.rad_s().value * scene.step_s);
    std::vector<std::complex<double>> turned(samples_, 1.0);
    for (std::size_t m = 1; m < samples_; ++m) turned[m] = turned[m - 1] * turn;
    for (std::size_t i = 0; i < scene.residual.size(); i += samples_) {
      std::complex<double> sum = 0.0;
      for (std::size_t m = 0; m < std::min(samples_, scene.residual.size() - i); ++m)
        sum += scene.residual[i + m] * turned[m];
      sums_.push_back(sum);
    }
  }
  double amplitude_at(double hz) const {
    const auto turn = std::polar(1.0, -Hertz{hz}.rad_s().value * block_s_);
    std::complex<double> pointer = 1.0;
    std::complex<double> all = 0.0;
    for (const auto& sum : sums_) {
      all += sum * pointer;
      pointer *= turn;
    }
    return scale_ * std::abs(all);
  }

 private:
  std::size_t samples_;
  double block_s_;
  double scale_;
  std::vector<std::complex<double>> sums_;
};

struct Line {
  double nominal_hz = 0.0;
  double hz = 0.0;
  double amplitude = 0.0;
  int harmonic = 1;

  /// Of harmonics that sampling folds to one place the lower one is likelier.
  double rank() const { return amplitude * (1.0 - kDoubtAHarmonic * harmonic); }
};

/// The largest line within the grid's tolerance of a nominal frequency.
Line largest_near(const Scene& scene, double nominal_hz) {
  const double step = kStep / scene.duration_s;
  const double reach = kTolerance * nominal_hz;
  const int count = whole_number<int>(std::ceil(reach / step));
  const auto frequency = [&](int k) { return nominal_hz + reach * k / count; };
  std::vector<double> rough;
  for (int first = -count; first <= count; first += kNeighbours) {
    const int last = std::min(first + kNeighbours - 1, count);
    const BlockSums sums(scene, 0.5 * (frequency(first) + frequency(last)));
    for (int k = first; k <= last; ++k) rough.push_back(sums.amplitude_at(frequency(k)));
  }
  const double enough = kNearlyLargest * *std::max_element(rough.begin(), rough.end());
  Line best{nominal_hz, nominal_hz, -1.0, 1};
  for (int k = -count; k <= count; ++k) {
    if (rough[static_cast<std::size_t>(k + count)] < enough) continue;
    const double hz = frequency(k);
    const double amplitude = amplitude_at(scene, hz);
    if (amplitude > best.amplitude) best = {nominal_hz, hz, amplitude, 1};
  }
  return best;
}

class MainsHum final : public Effect {
 public:
  MainsHum()
      : Effect({.name = "mains_hum",
                .what = "a sinusoid of the mains is added",
                .confused_with = {"resonance"},
                .experiment = "a record without drive: hum stays",
                .independent_of_input = true,
                .repeatable = true}) {}
  /// One line each, its frequency free within the grid's tolerance (above half the sampling rate it shows as
  /// its alias), its size and phase each record's own.
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    std::vector<Line> lines;
    const double rate = 1.0 / scene.step_s;
    for (double mains : {50.0, 60.0}) {
      for (int harmonic = 1; harmonic <= kHarmonics; ++harmonic) {
        const double hz = mains * harmonic;
        const double seen = alias_of(hz, rate);
        if (seen * scene.duration_s < kMinCycles || (0.5 * rate - seen) * scene.duration_s < kMinCycles)
          continue;
        lines.push_back(largest_near(scene, hz));
        lines.back().harmonic = harmonic;
      }
    }
    std::stable_sort(lines.begin(), lines.end(),
                     [](const Line& a, const Line& b) { return a.rank() > b.rank(); });
    std::vector<Line> proposed;
    for (const auto& line : lines) {
      if (proposed.size() >= kProposed) break;
      const bool seen = std::any_of(proposed.begin(), proposed.end(), [&](const Line& other) {
        return std::abs(alias_of(other.hz, rate) - alias_of(line.hz, rate)) * scene.duration_s < kApart;
      });
      if (!seen) proposed.push_back(line);
    }
    for (const auto& line : proposed) out.push_back(with_line(scene, line));
  }

 private:
  Proposal with_line(const Scene& scene, const Line& line) const {
    Model model = *scene.model;
    Term term;
    term.effect = this;
    term.placed = model.placed(model.size());
    const int id = model.insert(
        model.size(),
        chain::make_block("hum").set("amplitude", 0.0).set("frequency_hz", line.hz).set("phase_deg", 0.0));
    term.blocks = {id};
    term.lines = {id};
    auto frequency = linear_unknown("frequency_hz", (1.0 - kTolerance) * line.nominal_hz,
                                    (1.0 + kTolerance) * line.nominal_hz, 0.1 / scene.duration_s);
    frequency.unit = "Hz";
    term.unknowns = {frequency};
    term.write = [id](Model& m, std::span<const double> v) { m.block(id).set("frequency_hz", v[0]); };
    return propose_term(std::move(model), std::move(term), {{line.hz}});
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, mains_hum_effect, MainsHum)

}  // namespace bodesmith::gap
