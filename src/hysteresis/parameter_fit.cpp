#include "hysteresis/parameter_fit.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::hysteresis {

LeastSquaresResult fit_parameters(const std::function<void(const Eigen::VectorXd&, Eigen::VectorXd&)>& f,
                                  const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                  const Eigen::VectorXd& upper, const Eigen::VectorXd& typical,
                                  int iterations) {
  std::vector<SearchVariable> variables;
  for (Eigen::Index i = 0; i < start.size(); ++i)
    variables.push_back({.value = start(i),
                         .min = lower(i),
                         .max = upper(i),
                         .scale = std::max(std::abs(start(i)), std::abs(typical(i)))});
  const auto residuals = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    f(x, r);
    return true;
  };
  LeastSquaresResult out = least_squares(variables, residuals,
                                         {.max_iterations = iterations,
                                          .cost_tolerance = 1e-10,
                                          .difference = 1e-6,
                                          .broyden = false,
                                          .initial_damping = 1e-3});
  out.deviation = parameter_deviation(out.gram, out.residuals);
  return out;
}

}  // namespace bodesmith::hysteresis
