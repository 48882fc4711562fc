#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fit/cascade/cascade_bands.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "numeric/index.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith {
namespace {

/// Leaving out every point in turn is quadratic work per point; beyond this many it is not done.
constexpr std::size_t kMaxPointsToLeaveOut = 40;
/// An order above this is warned about: the paper bounds the fit at 5 when orders explode.
constexpr double kLargeOrder = 10.0;
/// Relative errors of the gains (some 1e-3) times this are as large as the orders themselves.
constexpr double kLargeCondition = 1e4;

/// d beta_i / d ln(gain_j) times ln 1.01; only orders that are not on a bound move. `weighted` when the orders are the
/// least squares of weighted points.
std::vector<std::vector<double>> order_sensitivities(const BandSolution& solution,
                                                     const std::vector<BodePoint>& above, bool weighted) {
  const std::size_t points = above.size();
  const std::size_t bands = solution.terms.size();
  std::vector<std::vector<double>> out(bands, std::vector<double>(points, 0.0));
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < bands; ++i) {
    if (solution.bound[i] == 0) free.push_back(i);
  }
  if (free.empty()) return out;
  LongMatrix part(points, LongVector(free.size()));
  std::vector<long double> root(points, 1.0L);
  for (std::size_t i = 0; i < points; ++i) {
    if (weighted) root[i] = std::sqrt(static_cast<long double>(above[i].weight));
    for (std::size_t j = 0; j < free.size(); ++j) part[i][j] = root[i] * solution.matrix[i][free[j]];
  }
  const LongMatrix inverse = least_squares_inverse(part);
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < points; ++j) {
      out[free[i]][j] = static_cast<double>(inverse[i][j] * root[j] * std::log(1.01L));
    }
  }
  return out;
}

/// Where the curve leaves what two neighbouring points span by more than surprise_db.
std::vector<Excursion> find_excursions(const BandSolution& solution, const CascadeProblem& problem,
                                       double surprise_db) {
  std::vector<Excursion> out;
  Hertz from = problem.base;
  double from_db = 0.0;
  for (const BodePoint& point : problem.above) {
    const double to_db = problem.target_db(point);
    Excursion found{{from, point.frequency}, from, 0.0};
    for (const Hertz f : log_grid({from, point.frequency}, 65)) {
      const double db = solution.curve_db(f);
      const double outside = std::max(db - std::max(from_db, to_db), std::min(from_db, to_db) - db);
      if (outside > found.outside_db) {
        found.outside_db = outside;
        found.worst = f;
      }
    }
    if (found.outside_db > surprise_db) out.push_back(found);
    from = point.frequency;
    from_db = to_db;
  }
  return out;
}

/// Every interior point left out in turn; none when there are so many that it takes too long.
std::vector<LeftOutPoint> leave_out_each(const BandSolution& solution, const CascadeProblem& problem,
                                         const CascadeFitOptions& options) {
  std::vector<LeftOutPoint> out;
  if (problem.above.size() < 2 || problem.above.size() > kMaxPointsToLeaveOut) return out;
  const auto grid = log_grid({problem.base, problem.above.back().frequency}, 241);
  for (std::size_t i = 0; i + 1 < problem.above.size(); ++i) {
    std::vector<BodePoint> others = problem.above;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const BandSolution without = solve_bands(problem, others, others, options);
    const BodePoint& point = problem.above[i];
    LeftOutPoint left;
    left.frequency = point.frequency;
    left.error_db = without.curve_db(point.frequency) - problem.target_db(point);
    left.max_change_at = point.frequency;
    for (const Hertz f : grid) {
      const double change = std::abs(without.curve_db(f) - solution.curve_db(f));
      if (change > left.max_change_db) {
        left.max_change_db = change;
        left.max_change_at = f;
      }
    }
    out.push_back(left);
  }
  return out;
}

/// What of all this a person should read.
std::vector<std::string> cascade_warnings(const CascadeFit& fit, const CascadeFitOptions& options) {
  std::vector<std::string> out;
  for (const Excursion& e : fit.excursions) {
    out.push_back(fmt::format(
        "between {} and {} the curve leaves the range of its two points by {} dB (at {}): add "
        "a point there",
        engineering_text(e.between.from.value, "Hz", 4), engineering_text(e.between.to.value, "Hz", 4),
        rounded_text(e.outside_db, 3), engineering_text(e.worst.value, "Hz")));
  }
  for (const LeftOutPoint& l : fit.left_out) {
    if (l.max_change_db <= options.surprise_db) continue;
    out.push_back(fmt::format(
        "the curve about {} is determined by this point alone: without it the error there is {} dB, "
        "and the curve changes by up to {} dB (at {})",
        engineering_text(l.frequency.value, "Hz", 4), rounded_text(l.error_db, 3),
        rounded_text(l.max_change_db, 3), engineering_text(l.max_change_at.value, "Hz")));
  }
  double max_order = 0.0;
  for (const CascadeFitTerm& term : fit.terms) max_order = std::max(max_order, std::abs(term.beta));
  if (!fit.bounded && max_order > kLargeOrder) {
    out.push_back(fmt::format("an order reaches {}: bound the exponents, or leave out a point",
                              rounded_text(max_order)));
  }
  if (fit.condition_number > kLargeCondition) {
    out.push_back(
        fmt::format("the equations are ill-conditioned ({}): the orders follow the noise of the gains",
                    rounded_text(fit.condition_number, 3)));
  }
  if (!fit.points_below_base.empty()) {
    out.push_back(
        fmt::format("{} point{} below the base frequency {} Hz left out", fit.points_below_base.size(),
                    fit.points_below_base.size() == 1 ? " was" : "s were", rounded_text(fit.base.value)));
  }
  return out;
}

constexpr double kSmallestRatio = 1e-3;
constexpr double kLargestRatio = 0.999;  ///< at 1 a term is 1, whatever its order

std::vector<FractionalLeadLag> terms_at(const Eigen::VectorXd& values) {
  std::vector<FractionalLeadLag> out;
  for (Eigen::Index i = 0; i + 1 < values.size(); i += 2) out.push_back({values(i), values(i + 1), 1.0});
  return out;
}

/// CascadeFitOptions::fitted_terms terms whose corners are searched, within a decade beyond base and last point, and with
/// ratios of up to 1000; bounds of the orders hold. Throws InputError when there are fewer than three points a term.
BandSolution fit_corners(const CascadeProblem& problem, const CascadeFitOptions& options) {
  const auto count = static_cast<std::size_t>(options.fitted_terms);
  if (3 * count > problem.above.size())
    throw InputError(
        fmt::format("{} terms with fitted corners need {} points above the base, expected at most {} terms",
                    count, 3 * count, problem.above.size() / 3));
  const double base = problem.base.rad_s().value;
  const double last = problem.above.back().frequency.rad_s().value;
  const double ratio = std::pow(base / last, 1.0 / static_cast<double>(count));
  std::vector<SearchVariable> unknowns;
  for (std::size_t i = 0; i < count; ++i) {
    const double corner = base * std::pow(ratio, -static_cast<double>(i));
    unknowns.push_back({1.0 / corner, 0.1 / last, 10.0 / base, true, 1.0});
    unknowns.push_back({std::max(ratio, kSmallestRatio), kSmallestRatio, kLargestRatio, true, 1.0});
  }
  const Residuals residuals = [&](const Eigen::VectorXd& values, Eigen::VectorXd& out) {
    const BandSolution solved = solve_orders(problem, terms_at(values), problem.above, options);
    out.resize(eigen_index(problem.above.size()));
    for (std::size_t i = 0; i < problem.above.size(); ++i) {
      const BodePoint& point = problem.above[i];
      out(eigen_index(i)) =
          std::sqrt(point.weight) * (solved.curve_db(point.frequency) - problem.target_db(point));
    }
    return out.allFinite();
  };
  LeastSquaresOptions search;
  search.max_iterations = 200;
  search.cost_tolerance = 1e-10;
  search.broyden = false;
  const LeastSquaresResult found = least_squares(unknowns, residuals, search);
  return solve_orders(problem, terms_at(found.values), problem.above, options);
}

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr std::size_t kMaxBandsOfAll = 300;  ///< when every point ends a band

void validate_bounds(const CascadeFitOptions& options) {
  if (options.beta_max && !(*options.beta_max > 0.0 && std::isfinite(*options.beta_max))) {
    throw InputError(fmt::format("beta_max is {}, expected a number above 0", *options.beta_max));
  }
  for (const double bound : options.term_beta_max) {
    if (!(bound > 0.0 && std::isfinite(bound)))
      throw InputError(fmt::format("a bound of beta is {}, expected a number above 0", bound));
  }
  if (options.beta_positive && !options.bounded()) {
    throw InputError("a positive beta needs an upper bound, expected beta_max too");
  }
  if (options.fewest_bands_db &&
      (!options.term_beta_max.empty() || options.fitted_terms > 0 || !options.corners.empty()))
    throw InputError(
        "the fewest bands have corners and a number of their own: expected neither corners nor bounds by term");
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
            "for the fewest bands, or a direct fit",
            problem.above.size(), kMaxBandsOfAll));
  }
  return {problem.above, true};
}

bool lower_in_frequency(const BodePoint& a, const BodePoint& b) {
  return a.frequency < b.frequency;
}

/// On the straight line between its neighbours in log gain over log frequency; it counts little.
BodePoint point_between(const CascadeProblem& problem, Hertz at) {
  Hertz from = problem.base;
  double from_gain = problem.base_gain;
  for (const BodePoint& point : problem.above) {
    if (point.frequency > at && from < at) {
      const double t = std::log(at.value / from.value) / std::log(point.frequency.value / from.value);
      BodePoint out;
      out.frequency = at;
      out.gain = from_gain * std::pow(point.gain / from_gain, t);
      out.weight = 1e-4;
      return out;
    }
    from = point.frequency;
    from_gain = point.gain;
  }
  throw InputError(
      fmt::format("a band cannot be split at {} Hz, expected a frequency between two points", at.value));
}

/// Sensitivities to measured points alone.
void keep_measured(std::vector<std::vector<double>>& sensitivity, const std::vector<BodePoint>& fitted,
                   const std::vector<BodePoint>& above) {
  if (fitted.size() == above.size()) return;
  for (std::vector<double>& row : sensitivity) {
    std::vector<double> kept;
    for (std::size_t j = 0; j < fitted.size(); ++j) {
      const auto measured = [&](const BodePoint& p) { return p.frequency == fitted[j].frequency; };
      if (std::ranges::any_of(above, measured)) kept.push_back(row[j]);
    }
    row = std::move(kept);
  }
}

/// `ends`: of the bands; empty where the corners are not those of bands.
std::vector<CascadeFitTerm> describe_terms(const BandSolution& solution, const CascadeProblem& problem,
                                           const std::vector<BodePoint>& ends,
                                           const std::vector<std::vector<double>>& sensitivity) {
  std::vector<CascadeFitTerm> out;
  for (std::size_t i = 0; i < solution.terms.size(); ++i) {
    CascadeFitTerm term;
    if (ends.empty()) {
      const FractionalLeadLag& made = solution.terms[i];
      term.band = {Hertz{made.low_corner().value / kTwoPi}, Hertz{made.high_corner().value / kTwoPi}};
    } else {
      term.band = {i == 0 ? problem.base : ends[i - 1].frequency, ends[i].frequency};
    }
    term.beta = solution.terms[i].beta;
    term.rises = solution.terms[i].rises();
    term.at_bound = solution.bound[i] != 0;
    if (!solution.upper.empty()) term.beta_max = solution.upper[i];
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

/// The fit's terms, what they were fitted to, and the ends of their bands where they have any.
struct Solved {
  BandSolution solution;
  std::vector<BodePoint> fitted;
  std::vector<BodePoint> ends;
  bool limit_met = true;
};

Solved solve(const BodePoints& points, const CascadeProblem& problem, const CascadeFitOptions& options) {
  Solved out;
  out.fitted = problem.above;
  if (options.fitted_terms > 0) {
    out.solution = fit_corners(problem, options);
    return out;
  }
  if (!options.corners.empty()) {
    out.solution = solve_orders(problem, options.corners, out.fitted, options);
    return out;
  }
  const BandChoice bands = band_ends(points, problem, options);
  out.ends = bands.ends;
  out.limit_met = bands.limit_met;
  for (const Hertz split : options.splits) {
    const BodePoint point = point_between(problem, split);
    out.ends.insert(std::upper_bound(out.ends.begin(), out.ends.end(), point, lower_in_frequency), point);
    out.fitted.insert(std::upper_bound(out.fitted.begin(), out.fitted.end(), point, lower_in_frequency),
                      point);
  }
  out.solution = solve_bands(problem, out.ends, out.fitted, options);
  return out;
}

}  // namespace

CascadeFit fit_cascade(const BodePoints& points, const CascadeFitOptions& options) {
  validate_bounds(options);
  const CascadeProblem problem = make_cascade_problem(points, options.base);
  const Solved solved = solve(points, problem, options);
  const BandSolution& solution = solved.solution;

  CascadeFit out;
  out.base = problem.base;
  out.points_below_base = problem.below;
  out.bounded = options.bounded();
  out.fewest_bands = options.fewest_bands_db.has_value();
  out.limit_met = solved.limit_met;
  if (out.bounded) {
    out.lower_bound = *std::ranges::min_element(solution.lower);
    out.upper_bound = *std::ranges::max_element(solution.upper);
  }
  out.optimality_residual = solution.optimality_residual;
  out.condition_number = condition_number(solution.matrix);
  const bool bands_of_points = !solved.ends.empty() && options.splits.empty();
  const bool weighted = out.bounded || solution.terms.size() < solved.fitted.size();
  out.least_squares = !out.bounded && weighted;
  out.sensitivity = order_sensitivities(solution, solved.fitted, weighted);
  keep_measured(out.sensitivity, solved.fitted, problem.above);
  out.terms = describe_terms(solution, problem, solved.ends, out.sensitivity);
  out.cascade.gain = problem.base_gain;
  out.cascade.terms = solution.terms;
  out.cascade.fit = summarise(out.cascade, problem, out.condition_number);
  out.base_got_db = solution.curve_db(problem.base);
  out.excursions = find_excursions(solution, problem, options.surprise_db);
  // With a point less there is a band less, and bounds by term fit no more.
  if (bands_of_points && !out.fewest_bands && options.term_beta_max.empty())
    out.left_out = leave_out_each(solution, problem, options);
  out.warnings = cascade_warnings(out, options);
  return out;
}

}  // namespace bodesmith
