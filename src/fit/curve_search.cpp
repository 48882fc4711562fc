#include "fit/curve_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "numeric/quadratic_program.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double rms(const VectorXd& miss) {
  return std::sqrt(miss.squaredNorm() / static_cast<double>(miss.size()));
}

/// Np: a fit this close is exact, and further steps would polish rounding.
constexpr double kExact = 1e-9;

/// Cost per neper of mask violation, against nepers of miss.
constexpr double kMaskCost = 100.0;

double mask_violation(const RootModel& model, const CurveTarget& target, const VectorXd& theta) {
  double worst = 0.0;
  for (const CurveTarget::Mask& mask : target.masks) {
    worst = std::max(worst, mask.side * (model.log_response(theta, mask.frequency).real() - mask.log_gain));
  }
  return worst;
}

}  // namespace

void curve_misses(const RootModel& model, const CurveTarget& target, const VectorXd& theta, VectorXd& miss,
                  MatrixXd* slope) {
  const auto n = static_cast<Index>(target.frequency.size());
  const bool phase = !target.phase_rad.empty();
  miss.resize(phase ? 2 * n : n);
  if (slope != nullptr) slope->resize(miss.size(), theta.size());
  Eigen::RowVectorXcd row(theta.size());
  const RootResponse response(model, theta);
  for (Index i = 0; i < n; ++i) {
    const auto at = static_cast<size_t>(i);
    const auto value = response.at(target.frequency[at], slope != nullptr ? &row : nullptr, phase);
    const double weight = target.weight[at];
    miss(i) = weight * (value.real() - target.log_gain[at]);
    if (slope != nullptr) slope->row(i) = weight * row.real();
    if (phase) {
      miss(n + i) = weight * (value.imag() - target.phase_rad[at]);
      if (slope != nullptr) slope->row(n + i) = weight * row.imag();
    }
  }
}

SearchResult search_least_squares(const RootModel& model, const Misses& misses, const RootLimits& limits,
                                  VectorXd theta, int iterations) {
  clamp(model, limits, theta);
  VectorXd miss;
  MatrixXd slope;
  misses(theta, miss, &slope);
  double value = miss.squaredNorm();
  double damping = 1e-2;
  int small = 0;
  for (int i = 0; i < iterations && damping < 1e10; ++i) {
    const MatrixXd normal = slope.transpose() * slope;
    const VectorXd downhill = -slope.transpose() * miss;
    MatrixXd damped = normal;
    damped.diagonal().array() +=
        damping * (1e-6 * normal.diagonal().maxCoeff() + normal.diagonal().array()) + 1e-14;
    VectorXd step = damped.ldlt().solve(downhill);
    const double largest = step.tail(step.size() - 1).cwiseAbs().maxCoeff();
    if (largest > 1.5) step *= 1.5 / largest;
    VectorXd trial = theta + step;
    clamp(model, limits, trial);
    VectorXd trial_miss;
    misses(trial, trial_miss, nullptr);
    const double trial_value = trial_miss.squaredNorm();
    if (trial_value < value) {
      small = value - trial_value < 1e-6 * value ? small + 1 : 0;
      theta = trial;
      value = trial_value;
      misses(theta, miss, &slope);
      damping = std::max(1e-9, damping / 5.0);
      if (small > 3) break;
    } else {
      damping *= 4.0;
    }
  }
  return {theta, std::sqrt(value / static_cast<double>(miss.size()))};
}

SearchResult search_least_squares(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  VectorXd theta, int iterations) {
  const Misses misses = [&](const VectorXd& at, VectorXd& miss, MatrixXd* slope) {
    curve_misses(model, target, at, miss, slope);
  };
  return search_least_squares(model, misses, limits, std::move(theta), iterations);
}

SearchResult search_constrained(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                VectorXd theta, bool least_squares, int iterations) {
  clamp(model, limits, theta);
  const Index n = theta.size();
  VectorXd miss;
  MatrixXd slope;
  const auto merit_of = [&](const VectorXd& at, const VectorXd& misses) {
    const double size = least_squares ? rms(misses) : misses.cwiseAbs().maxCoeff();
    return size + kMaskCost * mask_violation(model, target, at);
  };
  curve_misses(model, target, theta, miss, &slope);
  double merit = merit_of(theta, miss);
  double radius = 0.3;
  for (int iteration = 0; iteration < iterations && radius > 1e-10 && merit > kExact; ++iteration) {
    // Variables: the step, the level t (Chebyshev), the mask violation v.
    const Index level = least_squares ? -1 : n;
    const Index violation = target.masks.empty() ? -1 : n + (least_squares ? 0 : 1);
    const Index size = n + (level >= 0 ? 1 : 0) + (violation >= 0 ? 1 : 0);
    std::vector<Eigen::RowVectorXd> limit_rows;
    std::vector<double> limit_most;
    add_limits(model, limits, theta, limit_rows, limit_most);
    const Index misses = miss.size();
    const Index rows = (level >= 0 ? 2 * misses : 0) + static_cast<Index>(limit_rows.size()) + 2 * n +
                       (violation >= 0 ? static_cast<Index>(target.masks.size()) + 1 : 0);
    // In units of the present merit, so that the program is well scaled whatever the error.
    const double unit = std::max(merit, 1e-13);
    QuadraticProgram p;
    p.q = MatrixXd::Zero(size, size);
    p.c = VectorXd::Zero(size);
    p.a = MatrixXd::Zero(rows, size);
    p.b = VectorXd::Zero(rows);
    Index at = 0;
    // Steps in units of the radius.
    if (least_squares) {
      const double scale = radius / unit / std::sqrt(static_cast<double>(misses));
      p.q.topLeftCorner(n, n) = scale * scale * slope.transpose() * slope;
      p.c.head(n) = scale * slope.transpose() * miss / unit / std::sqrt(static_cast<double>(misses));
    } else {
      p.c(level) = 1.0;
      p.a.block(0, 0, misses, n) = slope * (radius / unit);
      p.a.block(misses, 0, misses, n) = -slope * (radius / unit);
      p.a.block(0, level, 2 * misses, 1).setConstant(-1.0);
      p.b.head(misses) = -miss / unit;
      p.b.segment(misses, misses) = miss / unit;
      at = 2 * misses;
    }
    for (size_t i = 0; i < limit_rows.size(); ++i, ++at) {
      p.a.block(at, 0, 1, n) = limit_rows[i];
      p.b(at) = std::max(0.0, limit_most[i]) / radius;
    }
    for (Index i = 0; i < n; ++i) {
      p.a(at, i) = 1.0;
      p.b(at++) = 1.0;
      p.a(at, i) = -1.0;
      p.b(at++) = 1.0;
    }
    if (violation >= 0) {
      Eigen::RowVectorXcd row;
      for (const CurveTarget::Mask& mask : target.masks) {
        const double value = model.log_response(theta, mask.frequency, &row).real();
        p.a.block(at, 0, 1, n) = mask.side * row.real() * (radius / unit);
        p.a(at, violation) = -1.0;
        p.b(at++) = mask.side * (mask.log_gain - value) / unit;
      }
      p.a(at, violation) = -1.0;
      p.b(at++) = 0.0;
      p.c(violation) = kMaskCost;
    }
    VectorXd start = VectorXd::Zero(size);
    if (level >= 0) start(level) = 1.1;
    if (violation >= 0) start(violation) = 1.0;
    const QuadraticProgramResult solution = solve_quadratic_program(p, start);
    VectorXd trial = theta + radius * solution.x.head(n);
    clamp(model, limits, trial);
    const VectorXd predicted_miss = miss + slope * (trial - theta);
    const double predicted = (least_squares ? rms(predicted_miss) : predicted_miss.cwiseAbs().maxCoeff()) +
                             (violation >= 0 ? kMaskCost * unit * std::max(0.0, solution.x(violation)) : 0.0);
    VectorXd trial_miss;
    curve_misses(model, target, trial, trial_miss, nullptr);
    const double trial_merit = merit_of(trial, trial_miss);
    const double hoped = merit - predicted;
    const double won = merit - trial_merit;
    if (won > 0.0) {
      const double step = (trial - theta).cwiseAbs().maxCoeff();
      theta = trial;
      merit = trial_merit;
      curve_misses(model, target, theta, miss, &slope);
      if (won > 0.75 * hoped && step > 0.9 * radius) radius = std::min(2.0, 2.0 * radius);
      if (won < 0.25 * hoped) radius *= 0.5;
      if (won < 1e-5 * merit && hoped < 1e-4 * merit) break;
    } else {
      radius *= 0.25;
      if (hoped < 1e-6 * merit) break;
    }
  }
  return {theta, merit};
}

SearchResult search_interpolation(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  VectorXd theta, int iterations) {
  VectorXd miss;
  MatrixXd slope;
  VectorXd best = theta;
  curve_misses(model, target, theta, miss, &slope);
  double value = miss.cwiseAbs().maxCoeff();
  for (int i = 0; i < iterations && value > 1e-14; ++i) {
    VectorXd step = slope.completeOrthogonalDecomposition().solve(-miss);
    const double largest = step.cwiseAbs().maxCoeff();
    if (largest > 0.5) step *= 0.5 / largest;
    theta += step;
    clamp(model, limits, theta);
    curve_misses(model, target, theta, miss, &slope);
    const double now = miss.cwiseAbs().maxCoeff();
    if (now < value) {
      value = now;
      best = theta;
    }
  }
  return {best, value};
}

}  // namespace bodesmith
