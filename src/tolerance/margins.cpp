#include "tolerance/margins.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/progress.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"
#include "tolerance/kernel.hpp"

namespace bodesmith::tolerance {
namespace {

/// By how much 1 + L turns round 0 over the grid.
double turned_rad(const std::vector<Complex>& loop) {
  double out = 0.0;
  for (std::size_t i = 1; i < loop.size(); ++i) out += std::arg((1.0 + loop[i]) / (1.0 + loop[i - 1]));
  return out;
}

/// The margins of one circuit's loop.
struct Drawn {
  double phase_margin_deg = 180.0;
  double gain_margin_db = NAN;
  double max_sensitivity = 0.0;
};

Drawn margins_of(const std::vector<Hertz>& grid, const std::vector<Complex>& loop, double nominal_turn) {
  const LoopMargins found = loop_margins(grid, loop);
  Drawn out;
  if (const auto* phase = found.least_phase_margin())
    out.phase_margin_deg = std::abs(phase->phase_margin_deg);
  if (std::abs(turned_rad(loop) - nominal_turn) > std::numbers::pi) out.phase_margin_deg *= -1.0;
  if (const auto* gain = found.least_gain_margin()) out.gain_margin_db = std::abs(gain->gain_margin_db);
  out.max_sensitivity = found.max_sensitivity;
  return out;
}

Json kept_json(const std::vector<double>& least_first) {
  if (least_first.empty()) return nullptr;
  return {{"p50", quantile_of_sorted(least_first, 0.5)},
          {"p5", kept_by_95(least_first)},
          {"min", least_first.front()}};
}

}  // namespace

double kept_by_95(const std::vector<double>& least_first) {
  return quantile_of_sorted(least_first, 0.05);
}

LoopStudy study_loop(const Design& design, const Options& options, const std::vector<Hertz>& grid,
                     const std::vector<Complex>& plant) {
  Options on_grid = options;
  on_grid.grid = grid;
  std::vector<Complex> wanted(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) wanted[i] = plant[i] * design.wanted(grid[i]);
  LoopStudy out;
  out.nominal = loop_margins(grid, wanted);
  const double nominal_turn = turned_rad(wanted);

  std::vector<Drawn> drawn(options.samples);
  constexpr std::uint64_t kBlock = Kernel::kBlock;
  const std::size_t blocks = (options.samples + kBlock - 1) / kBlock;
  const auto threads = static_cast<std::size_t>(thread_count(options.threads));
  parallel_for(threads, static_cast<int>(threads), [&](std::size_t thread) {
    Kernel kernel(design, on_grid);
    std::vector<Complex> loop(grid.size());
    for (std::size_t block = thread; block < blocks && !interrupted(); block += threads) {
      const std::uint64_t first = block * kBlock;
      const auto count = static_cast<int>(std::min(kBlock, options.samples - first));
      kernel.evaluate(first, count);
      for (int k = 0; k < count; ++k) {
        for (std::size_t i = 0; i < grid.size(); ++i)
          loop[i] =
              wanted[i] * std::polar(from_decibel(kernel.decibel(i)[k]), to_radians(kernel.degrees(i)[k]));
        drawn[first + static_cast<std::uint64_t>(k)] = margins_of(grid, loop, nominal_turn);
      }
    }
  });
  stop_if_interrupted();
  for (const Drawn& one : drawn) {
    out.unstable += one.phase_margin_deg < 0.0 ? 1 : 0;
    out.phase_margin_deg.push_back(one.phase_margin_deg);
    if (!std::isnan(one.gain_margin_db)) out.gain_margin_db.push_back(one.gain_margin_db);
    out.max_sensitivity.push_back(one.max_sensitivity);
  }
  for (std::vector<double>* all : {&out.phase_margin_deg, &out.gain_margin_db, &out.max_sensitivity})
    std::ranges::sort(*all);
  return out;
}

Json to_json(const LoopStudy& study) {
  return {{"nominal", to_json(study.nominal)},
          {"phase_margin_deg", kept_json(study.phase_margin_deg)},
          {"gain_margin_db", kept_json(study.gain_margin_db)},
          {"max_sensitivity",
           {{"p50", quantile_of_sorted(study.max_sensitivity, 0.5)},
            {"p95", quantile_of_sorted(study.max_sensitivity, 0.95)},
            {"max", study.max_sensitivity.back()}}},
          {"unstable", study.unstable}};
}

}  // namespace bodesmith::tolerance
