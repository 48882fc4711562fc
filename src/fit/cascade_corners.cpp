#include "fit/cascade_corners.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "numeric/index.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith {
namespace {

constexpr double kSmallestRatio = 1e-3;
constexpr double kLargestRatio = 0.999;  ///< at 1 a term is 1, whatever its order

std::vector<FractionalLeadLag> terms_at(const Eigen::VectorXd& values) {
  std::vector<FractionalLeadLag> out;
  for (Eigen::Index i = 0; i + 1 < values.size(); i += 2) out.push_back({values(i), values(i + 1), 1.0});
  return out;
}

}  // namespace

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

}  // namespace bodesmith
