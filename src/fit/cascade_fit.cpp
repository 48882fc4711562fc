#include "fit/cascade_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "fit/cascade_bands.hpp"
#include "fit/cascade_checks.hpp"

namespace bodesmith {
namespace {

constexpr std::size_t kMaxBandsOfAll = 300;  ///< when every point ends a band

void validate_bounds(const CascadeFitOptions& options) {
  if (options.beta_max && !(*options.beta_max > 0.0 && std::isfinite(*options.beta_max))) {
    throw InputError(fmt::format("beta_max is {}, expected a number above 0", *options.beta_max));
  }
  if (options.beta_positive && !options.beta_max) {
    throw InputError("a positive beta needs an upper bound, expected beta_max too");
  }
  if (options.fewest_bands_db && !(*options.fewest_bands_db > 0.0)) {
    throw InputError("the limit for the fewest bands is not above 0");
  }
}

/// Every point above the base, or the fewest of them.
BandChoice band_ends(const BodePoints& points, const CascadeProblem& problem,
                     const CascadeFitOptions& options) {
  if (options.fewest_bands_db) return choose_bands(problem, options, *options.fewest_bands_db);
  if (problem.above.size() > kMaxBandsOfAll) {
    throw InputError(
        points.file, 0,
        fmt::format(
            "has {} points above the base, which would make as many bands (at most {}): expected a limit "
            "for the fewest bands (--fewest-bands), or a direct fit",
            problem.above.size(), kMaxBandsOfAll));
  }
  return {problem.above, true};
}

std::vector<CascadeFitTerm> describe_terms(const BandSolution& solution, const CascadeProblem& problem,
                                           const std::vector<BodePoint>& ends,
                                           const std::vector<std::vector<double>>& sensitivity) {
  std::vector<CascadeFitTerm> out;
  for (std::size_t i = 0; i < solution.terms.size(); ++i) {
    CascadeFitTerm term;
    term.band = {i == 0 ? problem.base : ends[i - 1].frequency, ends[i].frequency};
    term.beta = solution.terms[i].beta;
    term.rises = term.beta > 0.0;
    term.at_bound = solution.bound[i] != 0;
    for (const double change : sensitivity[i])
      term.max_sensitivity = std::max(term.max_sensitivity, std::abs(change));
    out.push_back(term);
  }
  return out;
}

Cascade::FitSummary summarise(const Cascade& cascade, const CascadeProblem& problem,
                              double condition_number) {
  Cascade::FitSummary out;
  double square = 0.0;
  double weight = 0.0;
  for (const BodePoint& point : problem.above) {
    const double target = to_decibel(point.gain);
    const double got = cascade.magnitude_db(point.frequency.rad_s());
    out.points.push_back({point.frequency, target, got});
    square += point.weight * (got - target) * (got - target);
    weight += point.weight;
    out.max_db = std::max(out.max_db, std::abs(got - target));
  }
  out.rms_db = weight > 0.0 ? std::sqrt(square / weight) : 0.0;
  out.condition_number = condition_number;
  return out;
}

}  // namespace

CascadeFit fit_cascade(const BodePoints& points, const CascadeFitOptions& options) {
  validate_bounds(options);
  const CascadeProblem problem = make_cascade_problem(points, options.base);
  const BandChoice bands = band_ends(points, problem, options);
  const BandSolution solution = solve_bands(problem, bands.ends, problem.above, options);

  CascadeFit out;
  out.base = problem.base;
  out.points_below_base = problem.below;
  out.bounded = options.beta_max.has_value();
  out.fewest_bands = options.fewest_bands_db.has_value();
  out.limit_met = bands.limit_met;
  out.lower_bound = solution.lower;
  out.upper_bound = solution.upper;
  out.optimality_residual = solution.optimality_residual;
  out.condition_number = condition_number(solution.matrix);
  const bool weighted = out.bounded || bands.ends.size() < problem.above.size();
  out.sensitivity = order_sensitivities(solution, problem.above, weighted);
  out.terms = describe_terms(solution, problem, bands.ends, out.sensitivity);
  out.cascade.gain = problem.base_gain;
  out.cascade.terms = solution.terms;
  out.cascade.fit = summarise(out.cascade, problem, out.condition_number);
  out.base_got_db = solution.curve_db(problem.base);
  out.excursions = find_excursions(solution, problem, options.surprise_db);
  if (!out.fewest_bands) out.left_out = leave_out_each(solution, problem, options);
  out.warnings = cascade_warnings(out, options);
  return out;
}

}  // namespace bodesmith
