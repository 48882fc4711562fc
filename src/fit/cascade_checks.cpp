#include "fit/cascade_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace bodesmith {
namespace {

/// Leaving out every point in turn is quadratic work per point; beyond this many it is not done.
constexpr std::size_t kMaxPointsToLeaveOut = 40;
/// An order above this is warned about: the paper bounds the fit at 5 when orders explode.
constexpr double kLargeOrder = 10.0;
/// Relative errors of the gains (some 1e-3) times this are as large as the orders themselves.
constexpr double kLargeCondition = 1e4;

}  // namespace

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

}  // namespace bodesmith
