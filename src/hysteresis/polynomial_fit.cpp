#include "hysteresis/polynomial_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "hysteresis/polynomial_disturbance.hpp"
#include "numeric/dense.hpp"
#include "numeric/index.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {

double disturbance_gain(const std::array<double, 3>& basis, const std::array<double, 3>& other,
                        GainReading reading) {
  double cross = 0.0;
  double own = 0.0;
  const std::array<double, 3>& below = reading == GainReading::basis_times_gain ? basis : other;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double weight =
          1.0 / static_cast<double>(i + j + 3);  // the integral of x^(i+1) x^(j+1) over [0, 1]
      cross += weight * basis[i] * other[j];
      own += weight * below[i] * below[j];
    }
  }
  if (!(own > 0.0)) throw DesignError("the disturbance is zero everywhere: it has no gain");
  return cross / own;
}

PolynomialFit fit_polynomial(std::span<const double> x, std::span<const double> d) {
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d rhs = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double cube = x[i] * x[i] * x[i];
    const Eigen::Vector2d row(x[i] - cube, x[i] * x[i] - cube);
    gram += row * row.transpose();
    rhs += d[i] * row;
  }
  if (!(gram(0, 0) * gram(1, 1) - gram(0, 1) * gram(1, 0) > 1e-12 * gram(0, 0) * gram(1, 1)))
    throw DesignError("the samples do not cover the branch: a1 and a2 cannot be told apart");
  const Eigen::Vector2d a = solve_ldlt(gram, rhs);
  PolynomialFit out;
  out.a = {a(0), a(1), -a(0) - a(1)};
  Eigen::VectorXd residual(eigen_index(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i)
    residual(eigen_index(i)) = x[i] * (out.a[0] + x[i] * (out.a[1] + x[i] * out.a[2])) - d[i];
  const Eigen::VectorXd deviation = parameter_deviation(gram, residual);
  out.deviation = {deviation(0), deviation(1)};
  out.rms = std::sqrt(residual.squaredNorm() / static_cast<double>(std::max<std::size_t>(x.size(), 1)));
  return out;
}

SineFit fit_sine(std::span<const double> x, std::span<const double> d) {
  double top = 0.0;
  double bottom = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double s = std::sin(std::numbers::pi * x[i]);
    top += d[i] * s;
    bottom += s * s;
  }
  if (!(bottom > 0.0))
    throw DesignError("the samples do not cover the branch: the amplitude is not determined");
  SineFit out;
  out.amplitude = top / bottom;
  Eigen::VectorXd residual(eigen_index(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i)
    residual(eigen_index(i)) = out.amplitude * std::sin(std::numbers::pi * x[i]) - d[i];
  Eigen::MatrixXd gram(1, 1);
  gram(0, 0) = bottom;
  out.deviation = parameter_deviation(gram, residual)(0);
  out.rms = std::sqrt(residual.squaredNorm() / static_cast<double>(std::max<std::size_t>(x.size(), 1)));
  return out;
}

}  // namespace bodesmith::hysteresis
