#include "fpaa/search/fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/progress.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kLeastContinuous = 0.02;  ///< units, before the stage is scaled up

/// The free capacitors as unknowns.
struct FreeCapacitor {
  std::size_t stage = 0;
  std::size_t capacitor = 0;
};
std::vector<FreeCapacitor> free_capacitors(const Design& design) {
  std::vector<FreeCapacitor> out;
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    for (std::size_t c = 0; c < design.stages[s].c.size(); ++c) {
      if (design.stages[s].is_free(c)) out.push_back({s, c});
    }
  }
  return out;
}

/// One run of the least squares with these weights on top of the target's.
void fit_once(Design& design, const StageFactorTable& table, const std::vector<double>& lean,
              int iterations) {
  const std::vector<FreeCapacitor> list = free_capacitors(design);
  if (list.empty()) return;
  const auto points = static_cast<Eigen::Index>(table.target().grid.size());
  std::vector<SearchVariable> unknowns;
  for (const FreeCapacitor& f : list) {
    const double value = design.stages[f.stage].c[f.capacitor];
    const double most = 4.0 * kMostUnits;  // rounding scales stages down
    unknowns.push_back({.value = std::clamp(value, kLeastContinuous, most),
                        .min = kLeastContinuous,
                        .max = most,
                        .logarithmic = true});
  }
  Design trial = design;
  Eigen::VectorXd known;
  std::optional<DesignResponse>
      response;  // with the values `known`: derivatives are asked for where residuals were
  const auto set = [&](const Eigen::VectorXd& values) {
    if (known.size() == values.size() && known == values) return;
    known = values;
    response.reset();
    for (std::size_t i = 0; i < list.size(); ++i) {
      trial.stages[list[i].stage].c[list[i].capacitor] = values[static_cast<Eigen::Index>(i)];
    }
  };
  const auto response_there = [&]() -> const DesignResponse& {
    return response ? *response : response.emplace(trial, table);
  };
  const auto residuals = [&](const Eigen::VectorXd& values, Eigen::VectorXd& out) {
    stop_if_interrupted();
    set(values);
    if (!std::ranges::all_of(trial.stages, [](const DesignStage& stage) { return stage.is_stable(); })) {
      return false;
    }
    const std::vector<Complex> e = response_there().errors();
    out.resize(2 * points);
    for (Eigen::Index k = 0; k < points; ++k) {
      const Complex v = e[static_cast<std::size_t>(k)] * lean[static_cast<std::size_t>(k)];
      out[2 * k] = v.real();
      out[2 * k + 1] = v.imag();
    }
    return out.allFinite();
  };
  LeastSquaresOptions options;
  options.max_iterations = iterations;
  options.broyden = false;
  // What is nearly free (stages that could take over from one another) is not taken where rounding would have it: 1e-13 becomes 1e-9 by
  // this, a thousandth of what is snapped.
  options.least_damping = 1e-4;
  options.uncertainty = false;
  options.jacobian = [&](const Eigen::VectorXd& values, Eigen::MatrixXd& out) {
    set(values);
    out.resize(2 * points, static_cast<Eigen::Index>(list.size()));
    Eigen::Index column = 0;  // effects come in the order of the list
    const CapacitorEffects effects = capacitor_effects(response_there(), true);
    for (const CapacitorEffect& effect : effects.list) {
      for (Eigen::Index k = 0; k < points; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const Complex v = effect.values[i] * lean[i] / values[column];
        out(2 * k, column) = v.real();
        out(2 * k + 1, column) = v.imag();
      }
      ++column;
    }
  };
  const LeastSquaresResult result = least_squares(unknowns, residuals, options);
  set(result.values);
  design = std::move(trial);
}

}  // namespace

CapacitorEffects capacitor_effects(const DesignResponse& response, bool only_free) {
  const std::vector<DesignStage>& stages = response.design().stages;
  const std::size_t points = response.table().points();
  const std::vector<Parts> ways = response.ways();
  std::size_t count = 0;
  for (const DesignStage& stage : stages) count += stage.c.size();
  CapacitorEffects out;
  out.room = std::make_unique_for_overwrite<Complex[]>(count * points);
  Complex* room = out.room.get();
  for (std::size_t s = 0; s < stages.size(); ++s) {
    const DesignStage& stage = stages[s];
    if (only_free && stage.whole) continue;
    StagePlace(response, ways, s).slopes(stage, room);
    for (std::size_t c = 0; c < stage.c.size(); ++c, room += points) {
      if (stage.c[c] > 0.0 && (!only_free || stage.is_free(c))) out.list.push_back({s, c, {room, points}});
    }
  }
  return out;
}

void fit_design(Design& design, const StageFactorTable& table, int iterations, int passes) {
  std::vector<double> lean(table.target().grid.size(), 1.0);
  Design best = design;
  double least = 1e300;
  for (int pass = 0; pass < passes; ++pass) {
    fit_once(design, table, lean, iterations);
    const std::vector<Complex> e = DesignResponse(design, table).errors();
    const double worst = largest_error(e);
    if (worst < least) {
      least = worst;
      best = design;
    }
    if (pass + 1 == passes || !(worst > 0.0)) break;
    double mean = 0.0;
    for (std::size_t k = 0; k < lean.size(); ++k) {
      lean[k] *= std::sqrt(0.05 + std::abs(e[k]) / worst);
      mean += lean[k] / static_cast<double>(lean.size());
    }
    for (double& l : lean) l /= mean;
  }
  design = std::move(best);
  for (DesignStage& stage : design.stages) {
    for (double& c : stage.c) c = snapped(c);
  }
}

}  // namespace bodesmith::fpaa
