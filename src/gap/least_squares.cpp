#include "gap/least_squares.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace bodesmith::gap {
namespace {

double to_search(const Unknown& u, double value) {
  return u.logarithmic ? std::log(value) : value / u.scale;
}
double from_search(const Unknown& u, double s) {
  const double v = u.logarithmic ? std::exp(s) : s * u.scale;
  return std::clamp(v, u.low, u.high);
}

/// Difference step in search coordinates: large enough for an engine's own rounding, small against curvature.
constexpr double kDifference = 1e-4;

bool difference_column(const std::vector<Unknown>& unknowns, const Residuals& residuals,
                       std::vector<double> values, std::size_t j, const std::vector<double>& base,
                       std::vector<double>& column) {
  const Unknown& u = unknowns[j];
  const double s = to_search(u, values[j]);
  for (double sign : {1.0, -1.0}) {
    const double wanted = from_search(u, s + sign * kDifference);
    const double h = to_search(u, wanted) - s;
    if (std::abs(h) < 0.5 * kDifference) continue;  // at a bound: go the other way
    auto moved = values;
    moved[j] = wanted;
    if (!residuals(moved, column)) continue;
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = (column[i] - base[i]) / h;
    return true;
  }
  return false;
}

}  // namespace

std::vector<std::vector<double>> sensitivities(const std::vector<Unknown>& unknowns,
                                               const Residuals& residuals, const std::vector<double>& at) {
  std::vector<std::vector<double>> columns(unknowns.size());
  std::vector<double> base;
  if (!residuals(at, base)) return columns;
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    std::vector<double> column;
    if (difference_column(unknowns, residuals, at, j, base, column)) columns[j] = std::move(column);
  }
  return columns;
}

LeastSquaresResult least_squares(const std::vector<Unknown>& unknowns, const Residuals& residuals,
                                 const LeastSquaresOptions& options) {
  const auto p = static_cast<Eigen::Index>(unknowns.size());
  LeastSquaresResult result;
  for (const auto& u : unknowns) result.values.push_back(std::clamp(u.value, u.low, u.high));
  if (!residuals(result.values, result.residuals)) return result;
  result.runs = 1;
  result.usable = true;
  const auto n = static_cast<Eigen::Index>(result.residuals.size());
  Eigen::Map<Eigen::VectorXd> r(result.residuals.data(), n);
  double cost = r.squaredNorm();
  const auto finish_rms = [&] { result.rms = n > 0 ? std::sqrt(cost / static_cast<double>(n)) : 0.0; };
  finish_rms();
  if (p == 0) {
    result.converged = true;
    return result;
  }

  Eigen::MatrixXd jacobian(n, p);
  bool fresh = false;
  double damping = 1e-4;
  double growth = 2.0;
  std::vector<double> trial_residuals;
  int rank_one = 0;
  int failed = 0;  // trials the model could not be run at, in a row
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    if (options.stop && options.stop()) break;
    if (!fresh && rank_one == 0) {
      std::vector<double> column;
      for (Eigen::Index j = 0; j < p; ++j) {
        ++result.runs;
        if (difference_column(unknowns, residuals, result.values, static_cast<std::size_t>(j),
                              result.residuals, column)) {
          jacobian.col(j) = Eigen::Map<Eigen::VectorXd>(column.data(), n);
        } else {
          jacobian.col(j).setZero();
        }
      }
      fresh = true;
    }
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * r;
    bool moved = false;
    double drop = 0.0;
    for (int attempt = 0; attempt < 8; ++attempt) {
      Eigen::MatrixXd damped = normal;
      const double floor = 1e-12 * std::max(normal.diagonal().maxCoeff(), 1e-300);
      for (Eigen::Index j = 0; j < p; ++j) damped(j, j) += damping * std::max(normal(j, j), floor) + floor;
      // Unknowns that would go beyond a bound go to it, and the others take the step that is then best for
      // them (clipping alone would stall among many weights that may not be negative).
      std::vector<char> held(unknowns.size(), 0);
      Eigen::VectorXd fixed = Eigen::VectorXd::Zero(p);
      Eigen::VectorXd step;
      for (Eigen::Index pass = 0; pass <= p; ++pass) {
        Eigen::MatrixXd system = damped;
        Eigen::VectorXd right = -gradient - normal * fixed;
        for (Eigen::Index j = 0; j < p; ++j) {
          if (held[static_cast<std::size_t>(j)] == 0) continue;
          system.row(j).setZero();
          system.col(j).setZero();
          system(j, j) = 1.0;
          right(j) = fixed(j);
        }
        step = system.ldlt().solve(right);
        bool more = false;
        for (Eigen::Index j = 0; j < p && step.allFinite(); ++j) {
          if (held[static_cast<std::size_t>(j)] != 0) continue;
          const auto& u = unknowns[static_cast<std::size_t>(j)];
          const double here = to_search(u, result.values[static_cast<std::size_t>(j)]);
          const double low =
              std::isfinite(u.low) && !(u.logarithmic && u.low <= 0.0) ? to_search(u, u.low) : -1e300;
          const double high = std::isfinite(u.high) ? to_search(u, u.high) : 1e300;
          const double to = std::clamp(here + step(j), low, high);
          if (to == here + step(j)) continue;
          held[static_cast<std::size_t>(j)] = 1;
          fixed(j) = to - here;
          more = true;
        }
        if (!more) break;
      }
      if (!step.allFinite()) {
        damping *= 10.0;
        continue;
      }
      std::vector<double> trial(result.values);
      Eigen::VectorXd taken(p);
      for (Eigen::Index j = 0; j < p; ++j) {
        const auto& u = unknowns[static_cast<std::size_t>(j)];
        const double s = to_search(u, result.values[static_cast<std::size_t>(j)]);
        const double limit = u.logarithmic ? 1.0 : 1e6;
        const double to = from_search(u, s + std::clamp(step(j), -limit, limit));
        trial[static_cast<std::size_t>(j)] = to;
        taken(j) = to_search(u, to) - s;
      }
      if (!(taken.norm() > 1e-10)) break;
      ++result.runs;
      const bool ran = residuals(trial, trial_residuals);
      failed = ran ? 0 : failed + 1;
      if (ran) {
        Eigen::Map<Eigen::VectorXd> t(trial_residuals.data(), n);
        const double trial_cost = t.squaredNorm();
        if (trial_cost < cost) {
          const Eigen::VectorXd change = t - r;
          const Eigen::VectorXd predicted = jacobian * taken;
          const double foreseen = cost - (r + predicted).squaredNorm();
          const double ratio = foreseen > 0.0 ? (cost - trial_cost) / foreseen : 0.0;
          damping *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * ratio - 1.0, 3));
          damping = std::clamp(damping, 1e-12, 1e6);
          growth = 2.0;
          drop = (cost - trial_cost) / std::max(cost, 1e-300);
          cost = trial_cost;
          result.values = trial;
          result.residuals = trial_residuals;
          new (&r) Eigen::Map<Eigen::VectorXd>(result.residuals.data(), n);
          // Broyden: the cheapest Jacobian that explains the step just made.
          jacobian += (change - predicted) * taken.transpose() / taken.squaredNorm();
          fresh = false;
          moved = true;
          break;
        }
      }
      damping *= ran ? growth : 30.0 * growth;
      growth *= 2.0;
      // A stale Jacobian deserves the blame before the damping does.
      if (!fresh && attempt >= 1) break;
    }
    if (failed >= 6) break;
    if (!moved) {
      if (fresh) {
        result.converged = true;
        break;
      }
      rank_one = 0;
      continue;
    }
    if (drop < options.cost_tolerance) {
      if (rank_one == 0) {
        result.converged = true;
        break;
      }
      rank_one = 0;
      continue;
    }
    rank_one = drop > 0.02 && rank_one < 2 ? rank_one + 1 : 0;
  }
  finish_rms();

  // Uncertainty and conditioning from the last Jacobian; unknowns that rest at a bound or change nothing do
  // not count.
  Eigen::VectorXd scale = jacobian.colwise().norm();
  Eigen::MatrixXd scaled = jacobian;
  std::vector<Eigen::Index> counted;
  const double largest_scale = scale.maxCoeff();
  for (Eigen::Index j = 0; j < p; ++j) {
    const auto& u = unknowns[static_cast<std::size_t>(j)];
    const double value = result.values[static_cast<std::size_t>(j)];
    const bool at_bound = value <= u.low || value >= u.high;
    if (!at_bound && scale(j) > 1e-12 * largest_scale) counted.push_back(j);
    if (scale(j) > 0.0) scaled.col(j) /= scale(j);
  }
  const Eigen::MatrixXd gram = scaled.transpose() * scaled;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  double least = 1.0;
  double most = 1.0;
  if (!counted.empty()) {
    Eigen::MatrixXd part(static_cast<Eigen::Index>(counted.size()),
                         static_cast<Eigen::Index>(counted.size()));
    for (std::size_t i = 0; i < counted.size(); ++i) {
      for (std::size_t j = 0; j < counted.size(); ++j)
        part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = gram(counted[i], counted[j]);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_part(part);
    least = of_part.eigenvalues().minCoeff();
    most = of_part.eigenvalues().maxCoeff();
  }
  result.condition_number = least > 1e-30 * most ? std::sqrt(most / least) : 1e15;
  const Eigen::MatrixXd inverse =
      eigen.eigenvectors() *
      eigen.eigenvalues().cwiseMax(1e-15 * eigen.eigenvalues().maxCoeff()).cwiseInverse().asDiagonal() *
      eigen.eigenvectors().transpose();
  const double variance = cost / std::max<double>(1.0, static_cast<double>(n - p));
  result.deviation.resize(unknowns.size());
  for (Eigen::Index j = 0; j < p; ++j) {
    const auto& u = unknowns[static_cast<std::size_t>(j)];
    const double in_search = scale(j) > 0.0 ? std::sqrt(variance * inverse(j, j)) / scale(j) : 1e300;
    result.deviation[static_cast<std::size_t>(j)] =
        in_search * (u.logarithmic ? result.values[static_cast<std::size_t>(j)] : u.scale);
  }
  return result;
}

}  // namespace bodesmith::gap
