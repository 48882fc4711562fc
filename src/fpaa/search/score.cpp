#include "fpaa/search/score.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fpaa/plan/plan_limits.hpp"

namespace bodesmith::fpaa {
namespace {

/// An op-amp more has to earn this share of the error, a chip more that.
constexpr double kOpampCost = 0.01;
constexpr double kChipCost = 0.1;
/// A stage that AnadigmDesigner2 cannot make has to earn this much (a tenth of a point).
constexpr double kVendorMargin = 1e-3;

/// Mean square at the pin within the band, in kT/C_u: every switched unit brings 2 kT C of charge a period. What a slower clock folds
/// into the band is left out: this only compares designs.
double band_noise(const DesignResponse& response) {
  const DesignTarget& target = response.table().target();
  const Design& design = response.design();
  const std::size_t pairs = response.table().pairs();
  const std::vector<Parts> ways = response.ways();
  std::vector<Pair> sums(pairs, Pair{0.0, 0.0});  // per Hz
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    const DesignStage& stage = design.stages[s];
    const auto& clock = response.table().clock(stage.divisor);
    const double hz = target.master_hz / static_cast<double>(stage.divisor);
    for (int opamp = 1; opamp <= stage.opamps(); ++opamp) {
      const double charge = 2.0 * stage.switched_units(opamp) * 2.0 / hz;
      for (std::size_t k = 0; k < pairs; ++k) {
        const Parts y = charge_response(stage, opamp, clock[k]);
        const Parts& way = ways[s * pairs + k];
        sums[k] += charge * norm(product(y.end1, way.end1) + product(y.end2, way.end2) +
                                 product(y.mean1, way.mean1) + product(y.mean2, way.mean2));
      }
    }
  }
  const auto density = [&](std::size_t k) { return sums[k / 2][k % 2]; };
  double out = 0.0;
  for (std::size_t k = 0; k + 1 < target.grid.size(); ++k) {
    const double f = target.grid[k].hz().value;
    const double next = target.grid[k + 1].hz().value;
    if (target.weight[k] < 1.0 || target.weight[k + 1] < 1.0 || next < f) continue;
    out += 0.5 * (density(k) + density(k + 1)) * (next - f);
  }
  return out;
}

}  // namespace

double DesignScore::total() const {
  return std::hypot(p95, image) + noise + kOutside * std::max(0.0, kInputWorthKeeping * bound / input - 1.0);
}

double DesignScore::wanted_input() const {
  return std::min(kWantedInputV / kFullScaleV, kInputWorthKeeping * bound);
}

double DesignScore::missing() const {
  const auto beyond = [](double of_wanted) { return std::max(0.0, of_wanted - 1.0); };
  return beyond(designed / kWantedDesigned) + beyond(std::hypot(p95, noise) / kWantedP95) +
         beyond(wanted_input() / input);
}

double DesignScore::rank(int opamps, bool vendor) const {
  const int more_chips = (opamps - 1) / (kCabs * kOpAmps);
  return snapped((total() + designed) * (1.0 + kOpampCost * opamps + kChipCost * more_chips) +
                 (vendor ? 0.0 : kVendorMargin));
}

std::pair<int, double> DesignScore::place(double missing, int opamps, bool vendor) const {
  return {image > kUselessShare ? 2 : missing > 0.0 ? 1 : 0, snapped(rank(opamps, vendor) * (1.0 + missing))};
}

std::vector<double> errors_of_95_percent(const std::vector<Complex>& errors, const CapacitorEffects& effects,
                                         const Design& design, const MismatchModel& mismatch) {
  std::vector<double> out(errors.size(), 0.0);
  for (const CapacitorEffect& effect : effects.list) {
    const double sigma = mismatch.relative_sigma(design.stages[effect.stage].c[effect.capacitor]);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += std::norm(effect.values[k]) * sigma * sigma;
  }
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = error_of_95_percent(errors[k], std::sqrt(out[k]));
  return out;
}

namespace {

/// A signal where its phases begin, times exp(jwt) at their own time.
struct PhaseStarts {
  ComplexPair first = 1.0, second = 1.0;
};

/// The largest of each node where phases begin and end: it moves by its input alone in between.
void raise_peaks(const DesignResponse& response, std::vector<NodePeak>& out) {
  const Design& design = response.design();
  std::vector<PhaseStarts> starts(out.size());
  for (std::size_t k = 0; k < response.table().pairs(); ++k) {
    for (std::size_t s = 0; s < out.size(); ++s) {
      const DesignStage& stage = design.stages[s];
      const ClockFactors& clock = response.table().clock(stage.divisor)[k];
      const ComplexPair later = conj(clock.half);
      const Parts& y = response.signal(s, k);
      PhaseStarts& own = starts[s];
      own = {product(y.end1, later), product(y.end2, later)};
      for (std::size_t i = 0; i < stage.from.size(); ++i) {
        const StageFactors& f = response.factors(s, i, k);
        const Parts x = response.input_of(s, i, k);
        PhaseStarts in;
        if (stage.from[i] != DesignStage::kBoardInput) {
          const auto source = static_cast<std::size_t>(stage.from[i]);
          const bool same = design.stages[source].divisor == stage.divisor;
          in = {starts[source].first, same ? starts[source].second : starts[source].first};
        }
        own.first += f.follow1 * (product(x.end1, later) - in.first);
        own.second += f.follow2 * (product(x.end2, later) - in.second);
      }
      for (const ComplexPair& v : {y.end1, y.end2, own.first, own.second})
        out[s].output = std::max(out[s].output, largest_abs(v));
      if (stage.is_first()) continue;
      out[s].inner = std::max(out[s].inner, first_opamp(stage, clock, response.input_of(s, 0, k)).largest());
    }
  }
}

}  // namespace

std::vector<NodePeak> node_peaks(const DesignResponse& response) {
  constexpr int kAbove = 16;
  constexpr double kNearMultiple = 5e-4;  // of a clock: a slow stage takes for a constant what lies there
  constexpr int kMultiples = 3;
  std::vector<NodePeak> out(response.design().stages.size());
  raise_peaks(response, out);
  const DesignTarget& target = response.table().target();
  const double top =
      kOfFastest * target.master_hz / static_cast<double>(response.design().stages.front().divisor);
  if (!(top > target.band.to.value)) return out;
  DesignTarget above;
  above.master_hz = target.master_hz;
  for (const Hertz f : log_grid({target.band.to, {top}}, kAbove)) above.grid.push_back(f.rad_s());
  for (std::size_t s = 0; s < out.size(); ++s) {
    const std::vector<DesignStage>& stages = response.design().stages;
    if (s > 0 && stages[s].divisor == stages[s - 1].divisor) continue;
    const double clock = target.master_hz / static_cast<double>(stages[s].divisor);
    for (int k = 1; k <= kMultiples; ++k) {
      const Hertz f{(k + kNearMultiple) * clock};
      if (f.value < top) above.grid.push_back(f.rad_s());
    }
  }
  const StageFactorTable table(above);
  raise_peaks(DesignResponse(response.design(), table), out);
  return out;
}

void scale_nodes(Design& design, const StageFactorTable& table) {
  const std::vector<NodePeak> peaks = node_peaks(DesignResponse(design, table));
  const double end = peaks.back().output;
  const std::size_t count = peaks.size();
  if (!(end > 0.0)) return;
  for (std::size_t s = 0; s < count; ++s) {
    const double share = static_cast<double>(s + 1) / static_cast<double>(count);
    const double wanted = std::pow(end, share);
    if (s + 1 < count && peaks[s].output > 0.0) design.scale_node(s, wanted / peaks[s].output);
    DesignStage& stage = design.stages[s];
    if (stage.is_first() || !(peaks[s].inner > 0.0)) continue;
    // The first op-amp's output over q: CA, which feeds it back, and C3, which leaves it, times q. Its input scaled with the stage's.
    const double input = s == 0 ? 1.0 : std::pow(end, share - 1.0 / static_cast<double>(count));
    const double now = peaks[s].inner * (s + 1 < count ? wanted / peaks[s].output : 1.0);
    const double q = now / std::max({input, wanted, 1e-9});
    stage.c[DesignStage::kCA] *= q;
    stage.c[DesignStage::kC3] *= q;
  }
}

namespace {

double drawn_p95(const std::vector<Complex>& errors, const CapacitorEffects& effects, const Design& design,
                 const DesignTarget& target, const MismatchModel& mismatch) {
  constexpr std::size_t kDrawnAt = 50;  // of the grid, evenly
  constexpr int kBoards = 300;          // the same ones for every design: enough to tell which is better
  std::vector<std::size_t> at;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (target.weight[k] >= 1.0) at.push_back(k);
  }
  const std::size_t every = at.size() / kDrawnAt + 1;
  const auto thinned = [&](std::span<const Complex> values, double times) {
    std::vector<Complex> out;
    for (std::size_t i = 0; i < at.size(); i += every) out.push_back(times * values[at[i]]);
    return out;
  };
  std::vector<Complex> error = thinned(errors, 1.0);
  std::vector<std::vector<Complex>> of_sigma;
  for (const CapacitorEffect& effect : effects.list) {
    const double units = design.stages[effect.stage].c[effect.capacitor];
    of_sigma.push_back(thinned(effect.values, mismatch.relative_sigma(units)));
    const std::vector<Complex> systematic = thinned(effect.values, mismatch.systematic_units / units);
    for (std::size_t i = 0; i < error.size(); ++i) error[i] += systematic[i];
  }
  return error_of_95_percent(error, of_sigma, kBoards, 1);
}

/// The largest of all op-amps after a step.
double step_peak(const Design& design, const DesignTarget& target) {
  constexpr int kStepPoints = 80;
  DesignTarget steps;
  steps.master_hz = target.master_hz;
  const double fastest = target.master_hz / static_cast<double>(design.stages.front().divisor);
  const std::vector<Hertz> grid =
      log_grid({{0.01 * target.band.from.value}, {kOfFastest * fastest}}, kStepPoints);
  for (const Hertz f : grid) steps.grid.push_back(f.rad_s());
  const StageFactorTable table(steps);
  const DesignResponse response(design, table);
  const StepPeaks peaks(grid);
  double out = 0.0;
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    const DesignStage& stage = design.stages[s];
    std::vector<Complex> gain, inner;
    const auto add = [&](std::vector<Complex>& to, std::size_t k, const ComplexPair& of) {
      to.push_back(of.at(0));
      if (2 * k + 1 < grid.size()) to.push_back(of.at(1));
    };
    for (std::size_t k = 0; k < table.pairs(); ++k) add(gain, k, response.signal(s, k).whole());
    out = std::max(out, peaks.largest(gain));
    if (stage.is_first()) continue;
    for (std::size_t k = 0; k < table.pairs(); ++k)
      add(inner, k, first_opamp(stage, table.clock(stage.divisor)[k], response.input_of(s, 0, k)).end2);
    out = std::max(out, peaks.largest(inner));
  }
  return out;
}

}  // namespace

DesignScore score_of(const Design& design, const StageFactorTable& table, const BoardAssumptions& assumptions,
                     Spread spread) {
  const DesignResponse response(design, table);
  const DesignTarget& target = table.target();
  const std::vector<Complex> errors = response.errors();
  const CapacitorEffects effects = capacitor_effects(response);
  const std::vector<double> p95 = errors_of_95_percent(errors, effects, design, assumptions.mismatch);
  DesignScore out;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (target.weight[k] < 1.0) continue;
    const double designed = std::abs(errors[k]);
    if (!(designed <= out.designed)) out.designed = designed;
    if (!(p95[k] <= out.p95)) out.p95 = p95[k];
  }
  if (spread == Spread::by_drawn_boards)
    out.p95 = std::max(out.designed, drawn_p95(errors, effects, design, target, assumptions.mismatch));
  out.image = image_share(design, target);
  double most = 1.0;
  const std::vector<NodePeak> peaks = node_peaks(response);
  for (const NodePeak& peak : peaks) most = std::max({most, peak.output, peak.inner});
  if (spread == Spread::by_drawn_boards) most = std::max(most, step_peak(design, target));
  double asked = 1.0;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (target.weight[k] >= 1.0) asked = std::max(asked, std::abs(target.wanted[k]));
  }
  out.bound = 1.0 / asked;
  out.input = 1.0 / most;
  const double rms = assumptions.noise.unit_noise_v() * std::sqrt(band_noise(response));
  const double signal = out.input * kFullScaleV * peaks.back().output / std::numbers::sqrt2;
  out.noise = assumptions.noise.weight * rms / signal;
  return out;
}

}  // namespace bodesmith::fpaa
