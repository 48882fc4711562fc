#include "fit/cascade_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "numeric/bounded_least_squares.hpp"

namespace bodesmith {
namespace {

/// Leaving out every point in turn is quadratic work per point; beyond this many it is not done.
constexpr size_t kMostPointsToLeaveOut = 40;
/// An order above this is warned about: the paper bounds the fit at 5 when orders explode.
constexpr double kLargeOrder = 10.0;
constexpr double kLargeCondition = 1e4;
constexpr double kMostCandidates = 40.0;  ///< of band ends, when the fewest are looked for
constexpr double kMostChoices = 3e5;      ///< times points: how much trying out is worth
constexpr size_t kMostBands = 16;
constexpr size_t kMostBandsOfAll = 300;  ///< when every point ends a band

/// The base and the points above it, gains relative to the base.
struct Problem {
  Hertz base;
  double base_gain = 1.0;
  std::vector<BodePoint> above;
  std::vector<Hertz> below;
};

Problem make_problem(const BodePoints& points, const CascadeFitOptions& options) {
  Problem out;
  if (points.points.empty()) throw InputError(points.file, 0, "has no points");
  out.base = options.base.value_or(points.points.front().frequency);
  if (!(out.base.value > 0.0) || !std::isfinite(out.base.value)) {
    throw InputError(fmt::format("the base frequency is {} Hz, expected above 0", out.base.value));
  }
  for (const BodePoint& point : points.points) {
    if (point.frequency == out.base) {
      out.base_gain = point.gain;
    } else if (point.frequency < out.base) {
      out.below.push_back(point.frequency);
    } else {
      out.above.push_back(point);
    }
  }
  if (out.above.empty()) {
    throw InputError(
        points.file, points.points.back().line,
        fmt::format("has no point above the base frequency {} Hz, expected at least one", out.base.value));
  }
  return out;
}

std::vector<FractionalLeadLag> make_bands(Hertz base, const std::vector<BodePoint>& above) {
  std::vector<FractionalLeadLag> bands;
  Hertz from = base;
  for (const BodePoint& point : above) {
    bands.push_back({1.0 / from.rad_s().value, from.value / point.frequency.value, 1.0});
    from = point.frequency;
  }
  return bands;
}

LongMatrix make_matrix(const std::vector<FractionalLeadLag>& bands, const std::vector<BodePoint>& above) {
  LongMatrix a;
  for (const BodePoint& point : above) {
    LongVector row;
    for (const FractionalLeadLag& band : bands) row.push_back(band.log_magnitude(point.frequency.rad_s()));
    a.push_back(std::move(row));
  }
  return a;
}

struct Solution {
  std::vector<FractionalLeadLag> terms;
  LongMatrix matrix;
  std::vector<int> bound;
  double optimality_residual = 0.0;
  double lower = 0.0;
  double upper = 0.0;
};

/// Bands end at the points of `ends`, the orders are fitted to all of `above`.
Solution solve(Hertz base, double base_gain, const std::vector<BodePoint>& ends,
               const std::vector<BodePoint>& above, const CascadeFitOptions& options) {
  Solution out;
  out.terms = make_bands(base, ends);
  out.matrix = make_matrix(out.terms, above);
  out.bound.assign(ends.size(), 0);
  LongVector wanted;
  for (const BodePoint& point : above)
    wanted.push_back(std::log(static_cast<long double>(point.gain) / base_gain));
  LongVector beta;
  LongMatrix weighted = out.matrix;
  const bool interpolation = ends.size() == above.size() && !options.beta_max;
  if (!interpolation) {
    for (size_t i = 0; i < above.size(); ++i) {
      const long double root = std::sqrt(static_cast<long double>(above[i].weight));
      for (long double& value : weighted[i]) value *= root;
      wanted[i] *= root;
    }
  }
  if (!options.beta_max) {
    beta = least_squares(weighted, wanted);
  } else {
    out.upper = *options.beta_max;
    out.lower = options.beta_positive ? 0.0 : -out.upper;
    BoundedSolution solution = bounded_least_squares(weighted, wanted, out.lower, out.upper);
    beta = std::move(solution.x);
    out.bound = std::move(solution.bound);
    out.optimality_residual = static_cast<double>(solution.optimality_residual);
  }
  for (size_t i = 0; i < beta.size(); ++i) out.terms[i].beta = static_cast<double>(beta[i]);
  return out;
}

double curve_db(const std::vector<FractionalLeadLag>& terms, Hertz f) {
  double np = 0.0;
  for (const FractionalLeadLag& term : terms) np += term.log_magnitude(f.rad_s());
  return kDecibelPerNeper * np;
}

/// d beta / d ln(gain_j) times ln 1.01; only orders that are not on a bound move.
std::vector<std::vector<double>> sensitivities(const Solution& solution, const std::vector<BodePoint>& above,
                                               bool weighted) {
  const size_t n = above.size();
  const size_t bands = solution.terms.size();
  std::vector<std::vector<double>> out(bands, std::vector<double>(n, 0.0));
  std::vector<size_t> free;
  for (size_t i = 0; i < bands; ++i) {
    if (solution.bound[i] == 0) free.push_back(i);
  }
  if (free.empty()) return out;
  LongMatrix part(n, LongVector(free.size()));
  std::vector<long double> root(n, 1.0L);
  for (size_t i = 0; i < n; ++i) {
    if (weighted) root[i] = std::sqrt(static_cast<long double>(above[i].weight));
    for (size_t j = 0; j < free.size(); ++j) part[i][j] = root[i] * solution.matrix[i][free[j]];
  }
  const LongMatrix inverse = least_squares_inverse(part);
  for (size_t i = 0; i < free.size(); ++i) {
    for (size_t j = 0; j < n; ++j) {
      out[free[i]][j] = static_cast<double>(inverse[i][j] * root[j] * std::log(1.01L));
    }
  }
  return out;
}

void find_excursions(CascadeFit& fit, const Problem& problem, double surprise_db) {
  Hertz from = problem.base;
  double from_db = 0.0;
  for (const BodePoint& point : problem.above) {
    const double to_db = to_decibel(point.gain / problem.base_gain);
    Excursion found{{from, point.frequency}, from, 0.0};
    for (const Hertz f : log_grid({from, point.frequency}, 65)) {
      const double db = curve_db(fit.cascade.terms, f);
      const double outside = std::max(db - std::max(from_db, to_db), std::min(from_db, to_db) - db);
      if (outside > found.outside_db) {
        found.outside_db = outside;
        found.worst = f;
      }
    }
    if (found.outside_db > surprise_db) fit.excursions.push_back(found);
    from = point.frequency;
    from_db = to_db;
  }
}

void leave_out_each(CascadeFit& fit, const Problem& problem, const CascadeFitOptions& options) {
  if (problem.above.size() < 2 || problem.above.size() > kMostPointsToLeaveOut) return;
  const auto grid = log_grid({problem.base, problem.above.back().frequency}, 241);
  for (size_t i = 0; i + 1 < problem.above.size(); ++i) {
    std::vector<BodePoint> others = problem.above;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Solution solution = solve(problem.base, problem.base_gain, others, others, options);
    const BodePoint& point = problem.above[i];
    LeftOutPoint left;
    left.frequency = point.frequency;
    left.miss_db = curve_db(solution.terms, point.frequency) - to_decibel(point.gain / problem.base_gain);
    left.max_change_at = point.frequency;
    for (const Hertz f : grid) {
      const double change = std::abs(curve_db(solution.terms, f) - curve_db(fit.cascade.terms, f));
      if (change > left.max_change_db) {
        left.max_change_db = change;
        left.max_change_at = f;
      }
    }
    fit.left_out.push_back(left);
  }
}

void add_warnings(CascadeFit& fit, const CascadeFitOptions& options) {
  for (const Excursion& e : fit.excursions) {
    fit.warnings.push_back(
        fmt::format("between {} and {} Hz the curve leaves the range of its two points by {} dB (at {} Hz): add "
                    "a point there",
                    rounded_text(e.between.from.value), rounded_text(e.between.to.value),
                    rounded_text(e.outside_db, 3), rounded_text(e.worst.value, 3)));
  }
  for (const LeftOutPoint& l : fit.left_out) {
    if (l.max_change_db <= options.surprise_db) continue;
    fit.warnings.push_back(
        fmt::format("the curve depends on the point at {} Hz: without it the error there is {} dB, "
                    "and the curve changes by up to {} dB (at {} Hz)",
                    rounded_text(l.frequency.value), rounded_text(l.miss_db, 3),
                    rounded_text(l.max_change_db, 3), rounded_text(l.max_change_at.value, 3)));
  }
  double largest = 0.0;
  for (const CascadeFitTerm& term : fit.terms) largest = std::max(largest, std::abs(term.beta));
  if (!fit.bounded && largest > kLargeOrder) {
    fit.warnings.push_back(fmt::format(
        "an order reaches {}: bound the fit with --beta-max, or leave out a point", rounded_text(largest)));
  }
  if (fit.condition_number > kLargeCondition) {
    fit.warnings.push_back(
        fmt::format("the equations are ill-conditioned ({}): the orders follow the noise of the gains",
                    rounded_text(fit.condition_number, 3)));
  }
  if (!fit.points_below_base.empty()) {
    fit.warnings.push_back(
        fmt::format("{} point{} below the base frequency {} Hz left out", fit.points_below_base.size(),
                    fit.points_below_base.size() == 1 ? " was" : "s were", rounded_text(fit.base.value)));
  }
}

double largest_miss_db(const Solution& solution, const Problem& problem) {
  double worst = 0.0;
  for (const BodePoint& point : problem.above) {
    if (point.weight == 0.0) continue;
    worst = std::max(worst, std::abs(curve_db(solution.terms, point.frequency) -
                                     to_decibel(point.gain / problem.base_gain)));
  }
  return worst;
}

/// The fewest points at which bands end so that no point is missed by more than the limit: every choice where
/// they are few, otherwise added where the curve is worst and then taken away again where it does not matter.
std::vector<BodePoint> choose_bands(const Problem& problem, const CascadeFitOptions& options, bool& met) {
  // Candidates: the points, thinned evenly in log frequency when there are many; the last one always.
  std::vector<BodePoint> candidates;
  const double span = std::log(problem.above.back().frequency.value / problem.base.value);
  double next = 0.0;
  for (const BodePoint& point : problem.above) {
    const double at = std::log(point.frequency.value / problem.base.value);
    if (at >= next - 1e-12 || &point == &problem.above.back()) {
      candidates.push_back(point);
      next = at + span / kMostCandidates;
    }
  }
  const BodePoint last = candidates.back();
  candidates.pop_back();
  const double limit = *options.fewest_bands_db;
  const auto miss = [&](const std::vector<size_t>& inner) {
    std::vector<BodePoint> ends;
    for (const size_t i : inner) ends.push_back(candidates[i]);
    ends.push_back(last);
    return largest_miss_db(solve(problem.base, problem.base_gain, ends, problem.above, options), problem);
  };
  const auto ends_of = [&](const std::vector<size_t>& inner) {
    std::vector<BodePoint> ends;
    for (const size_t i : inner) ends.push_back(candidates[i]);
    ends.push_back(last);
    return ends;
  };
  // Every choice of k inner points, as long as there are not too many.
  const size_t n = candidates.size();
  double choices = 1.0;
  size_t k = 0;
  for (; k <= n && choices * static_cast<double>(problem.above.size()) <= kMostChoices; ++k) {
    std::vector<size_t> inner(k);
    for (size_t i = 0; i < k; ++i) inner[i] = i;
    double best = INFINITY;
    std::vector<size_t> best_inner;
    for (;;) {
      const double here = miss(inner);
      if (here < best) {
        best = here;
        best_inner = inner;
      }
      size_t i = k;
      while (i > 0 && inner[i - 1] == n - k + i - 1) --i;
      if (i == 0) break;
      ++inner[i - 1];
      for (size_t j = i; j < k; ++j) inner[j] = inner[j - 1] + 1;
    }
    if (best <= limit) {
      met = true;
      return ends_of(best_inner);
    }
    choices *= static_cast<double>(n - k) / static_cast<double>(k + 1);
  }
  std::vector<size_t> inner;
  while (inner.size() < std::min(n, kMostBands)) {
    std::vector<size_t> best_inner;
    double best = INFINITY;
    for (size_t i = 0; i < n; ++i) {
      if (std::find(inner.begin(), inner.end(), i) != inner.end()) continue;
      std::vector<size_t> trial = inner;
      trial.insert(std::upper_bound(trial.begin(), trial.end(), i), i);
      const double here = miss(trial);
      if (here < best) {
        best = here;
        best_inner = trial;
      }
    }
    inner = best_inner;
    if (best <= limit) break;
  }
  met = miss(inner) <= limit;
  for (size_t i = 0; met && i < inner.size();) {
    std::vector<size_t> trial = inner;
    trial.erase(trial.begin() + static_cast<std::ptrdiff_t>(i));
    if (miss(trial) <= limit)
      inner = trial;
    else
      ++i;
  }
  return ends_of(inner);
}

}  // namespace

CascadeFit fit_cascade(const BodePoints& points, const CascadeFitOptions& options) {
  if (options.beta_max && !(*options.beta_max > 0.0 && std::isfinite(*options.beta_max))) {
    throw InputError(fmt::format("beta_max is {}, expected a number above 0", *options.beta_max));
  }
  if (options.beta_positive && !options.beta_max) {
    throw InputError("a positive beta needs an upper bound, expected beta_max too");
  }
  const Problem problem = make_problem(points, options);
  if (options.fewest_bands_db && !(*options.fewest_bands_db > 0.0)) {
    throw InputError("the limit for the fewest bands is not above 0");
  }
  if (!options.fewest_bands_db && problem.above.size() > kMostBandsOfAll) {
    throw InputError(
        points.file, 0,
        fmt::format(
            "has {} points above the base, which would make as many bands (at most {}): expected a limit "
            "for the fewest bands (--fewest-bands), or a direct fit",
            problem.above.size(), kMostBandsOfAll));
  }
  CascadeFit out;
  std::vector<BodePoint> ends = problem.above;
  if (options.fewest_bands_db) {
    out.fewest_bands = true;
    ends = choose_bands(problem, options, out.limit_met);
  }
  const Solution solution = solve(problem.base, problem.base_gain, ends, problem.above, options);

  out.base = problem.base;
  out.points_below_base = problem.below;
  out.bounded = options.beta_max.has_value();
  out.lower_bound = solution.lower;
  out.upper_bound = solution.upper;
  out.optimality_residual = solution.optimality_residual;
  out.condition_number = condition_number(solution.matrix);
  out.cascade.gain = problem.base_gain;
  out.cascade.terms = solution.terms;
  out.sensitivity = sensitivities(solution, problem.above, out.bounded || ends.size() < problem.above.size());
  for (size_t i = 0; i < solution.terms.size(); ++i) {
    const FractionalLeadLag& term = solution.terms[i];
    CascadeFitTerm info;
    info.band = {i == 0 ? problem.base : ends[i - 1].frequency, ends[i].frequency};
    info.beta = term.beta;
    info.rises = term.beta > 0.0;
    info.at_bound = solution.bound[i] != 0;
    for (const double change : out.sensitivity[i])
      info.max_sensitivity = std::max(info.max_sensitivity, std::abs(change));
    out.terms.push_back(info);
  }

  Cascade::FitSummary summary;
  double square = 0.0;
  double weight = 0.0;
  for (const BodePoint& point : problem.above) {
    const double wanted = to_decibel(point.gain);
    const double got = out.cascade.magnitude_db(point.frequency.rad_s());
    summary.points.push_back({point.frequency, wanted, got});
    square += point.weight * (got - wanted) * (got - wanted);
    weight += point.weight;
    summary.max_db = std::max(summary.max_db, std::abs(got - wanted));
  }
  summary.rms_db = weight > 0.0 ? std::sqrt(square / weight) : 0.0;
  summary.condition_number = std::isfinite(out.condition_number) ? out.condition_number : 1e300;
  out.cascade.fit = summary;
  out.base_got_db = curve_db(solution.terms, problem.base);

  find_excursions(out, problem, options.surprise_db);
  if (!out.fewest_bands) leave_out_each(out, problem, options);
  add_warnings(out, options);
  return out;
}

Json CascadeFit::to_json() const {
  Json out = cascade.to_json();
  Json& fit = out["fit"];
  fit["kind"] = bounded ? "bounded" : fewest_bands ? "least squares" : "interpolation";
  if (fewest_bands) fit["limit_met"] = limit_met;
  if (bounded) {
    fit["beta_bounds"] = {lower_bound, upper_bound};
    fit["optimality_residual"] = optimality_residual;
  }
  fit["base"] = {{"frequency_hz", base.value}, {"got_relative_db", base_got_db}};
  fit["terms"] = Json::array();
  for (size_t i = 0; i < terms.size(); ++i) {
    const CascadeFitTerm& term = terms[i];
    fit["terms"].push_back({{"from_hz", term.band.from.value},
                            {"to_hz", term.band.to.value},
                            {"beta", term.beta},
                            {"orientation", term.beta == 0.0 ? "flat"
                                            : term.rises     ? "lead"
                                                             : "lag"},
                            {"slope_db", 20.0 * term.beta},
                            {"at_bound", term.at_bound},
                            {"beta_change_per_gain_percent", sensitivity[i]},
                            {"max_beta_change_per_gain_percent", term.max_sensitivity}});
  }
  fit["left_out"] = Json::array();
  for (const LeftOutPoint& l : left_out) {
    fit["left_out"].push_back({{"frequency_hz", l.frequency.value},
                               {"miss_db", l.miss_db},
                               {"max_change_db", l.max_change_db},
                               {"max_change_hz", l.max_change_at.value}});
  }
  fit["excursions"] = Json::array();
  for (const Excursion& e : excursions) {
    fit["excursions"].push_back({{"from_hz", e.between.from.value},
                                 {"to_hz", e.between.to.value},
                                 {"worst_hz", e.worst.value},
                                 {"outside_db", e.outside_db}});
  }
  Json below = Json::array();
  for (const Hertz f : points_below_base) below.push_back(f.value);
  fit["points_below_base_hz"] = below;
  fit["warnings"] = warnings;
  return out;
}

}  // namespace bodesmith
