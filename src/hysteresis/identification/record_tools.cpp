#include "hysteresis/identification/record_tools.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "hysteresis/polynomial_disturbance.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::hysteresis {

std::size_t first_counted(const TimeRecord& record, double skip_s) {
  const double steps = std::ceil(skip_s / record.step_s - 1e-9);
  if (!(steps > 0.0)) return 0;
  return steps >= static_cast<double>(record.size()) ? record.size() - 1 : static_cast<std::size_t>(steps);
}

std::size_t counted_samples(std::span<const TimeRecord> records, double skip_s) {
  std::size_t out = 0;
  for (const TimeRecord& record : records) out += record.size() - first_counted(record, skip_s);
  return out;
}

Range input_range(std::span<const TimeRecord> records, double skip_s) {
  Range out;
  for (const TimeRecord& record : records)
    for (std::size_t i = first_counted(record, skip_s); i < record.size(); ++i) out.include(record.u[i]);
  return out;
}

Range output_range(std::span<const TimeRecord> records, double skip_s) {
  Range out;
  for (const TimeRecord& record : records)
    for (std::size_t i = first_counted(record, skip_s); i < record.size(); ++i) out.include(record.y[i]);
  return out;
}

Range swept_range(std::span<const TimeRecord> records, double skip_s) {
  const Range out = input_range(records, skip_s);
  if (!(out.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  return out;
}

Eigen::VectorXd counted_outputs(std::span<const TimeRecord> records, double skip_s) {
  Eigen::VectorXd out(eigen_index(counted_samples(records, skip_s)));
  Eigen::Index at = 0;
  for (const TimeRecord& record : records)
    for (std::size_t i = first_counted(record, skip_s); i < record.size(); ++i) out(at++) = record.y[i];
  return out;
}

void operator_residual(Operator&& op, std::span<const TimeRecord> records, double skip_s,
                       Eigen::VectorXd& residual) {
  residual.resize(eigen_index(counted_samples(records, skip_s)));
  Eigen::Index at = 0;
  drive(op, records, skip_s,
        [&](double y, const TimeRecord& record, std::size_t i) { residual(at++) = y - record.y[i]; });
}

std::vector<Branch> branches(const std::vector<double>& u, double dead) {
  std::vector<Branch> out;
  if (u.size() < 2) return out;
  Range range;
  for (const double value : u) range.include(value);
  const double min_move = dead * range.width();
  if (!(range.width() > 0.0)) return out;
  std::size_t first = 0;
  std::size_t extreme = 0;
  int direction = 0;
  for (std::size_t i = 1; i < u.size(); ++i) {
    if (direction == 0) {
      if (u[i] > u[first] + min_move) direction = 1;
      if (u[i] < u[first] - min_move) direction = -1;
      extreme = i;
      continue;
    }
    if ((u[i] - u[extreme]) * direction >= 0.0) {
      extreme = i;
    } else if ((u[extreme] - u[i]) * direction > min_move) {
      out.push_back({first, extreme, direction > 0});
      first = extreme;
      direction = -direction;
      extreme = i;
    }
  }
  if (direction != 0 && extreme > first) out.push_back({first, extreme, direction > 0});
  return out;
}

void add_uncertainty(std::vector<ParameterUncertainty>& out, std::string_view list,
                     const Eigen::VectorXd& values, const Eigen::VectorXd& deviations, Eigen::Index from,
                     Eigen::Index count) {
  for (Eigen::Index i = 0; i < count; ++i)
    out.push_back({fmt::format("{}[{}]", list, i), values(from + i), deviations(from + i)});
}

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
  return out;
}

double fit_sine(std::span<const double> x, std::span<const double> d) {
  double top = 0.0;
  double bottom = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double s = std::sin(std::numbers::pi * x[i]);
    top += d[i] * s;
    bottom += s * s;
  }
  if (!(bottom > 0.0))
    throw DesignError("the samples do not cover the branch: the amplitude is not determined");
  return top / bottom;
}

}  // namespace bodesmith::hysteresis
