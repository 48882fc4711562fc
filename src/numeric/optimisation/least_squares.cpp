#include "numeric/optimisation/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double to_search(const SearchVariable& u, double value) {
  return u.logarithmic ? std::log(value) : value / u.scale;
}
double from_search(const SearchVariable& u, double s) {
  return std::clamp(u.logarithmic ? std::exp(s) : s * u.scale, u.min, u.max);
}
/// d(value)/d(search coordinate).
double search_slope(const SearchVariable& u, double value) {
  return u.logarithmic ? value : u.scale;
}
double clamped_in_search(const SearchVariable& u, double s) {
  const double least = u.logarithmic ? std::max(u.min, 0.0) : u.min;
  return std::clamp(s, to_search(u, least), to_search(u, u.max));
}

/// One column by a forward difference, backward at an upper bound; nothing where neither can be run.
std::optional<VectorXd> difference_column(const SearchVariable& u, Index j, const Residuals& residuals,
                                          const VectorXd& values, const VectorXd& base, double difference) {
  const double s = to_search(u, values(j));
  VectorXd column;
  for (const double sign : {1.0, -1.0}) {
    VectorXd moved = values;
    moved(j) = from_search(u, s + sign * difference);
    const double h = to_search(u, moved(j)) - s;
    if (std::abs(h) < 0.5 * difference) continue;  // at a bound: go the other way
    if (residuals(moved, column)) return (column - base) / h;
  }
  return std::nullopt;
}

/// The run of one fit: values, residuals and the Jacobian that is being kept.
class LevenbergMarquardt {
 public:
  LevenbergMarquardt(const std::vector<SearchVariable>& unknowns, const Residuals& residuals,
                     const LeastSquaresOptions& options)
      : unknowns_(unknowns),
        residuals_(residuals),
        options_(options),
        p_(eigen_index(unknowns.size())),
        damping_(options.initial_damping) {}

  LeastSquaresResult run();

 private:
  enum class Trial { better, worse, not_runnable };
  /// An iteration's end: whether the values moved, and by how much the cost fell relative to itself.
  struct Progress {
    bool moved = false;
    double drop = 0.0;
  };

  const SearchVariable& unknown(Index j) const { return unknowns_[std_index(j)]; }
  bool start();
  Termination iterate();
  void renew_jacobian();
  Progress improve();
  VectorXd bounded_step(const MatrixXd& damped, const MatrixXd& normal, const VectorXd& gradient) const;
  VectorXd moved_by(const VectorXd& step, VectorXd& taken) const;
  Trial attempt(const VectorXd& values, const VectorXd& taken, double& drop);
  void judge_uncertainty();

  const std::vector<SearchVariable>& unknowns_;
  const Residuals& residuals_;
  const LeastSquaresOptions& options_;
  Index p_;
  LeastSquaresResult result_;
  MatrixXd jacobian_;  ///< with respect to the search coordinates
  bool fresh_ = false;
  int rank_one_ = 0;  ///< updates since the last fresh Jacobian
  double damping_;
  double growth_ = 2.0;
  int failed_ = 0;  ///< trials the model could not be run at, in a row
};

/// Trials that cannot be run, in a row, after which the search ends.
constexpr int kMaxFailed = 6;
constexpr int kMaxRankOne = 2;
/// Relative drop of the cost above which a rank-one update is tried instead of a fresh Jacobian.
constexpr double kPayingDrop = 0.02;

bool LevenbergMarquardt::start() {
  result_.values.resize(p_);
  for (Index j = 0; j < p_; ++j)
    result_.values(j) = std::clamp(unknown(j).value, unknown(j).min, unknown(j).max);
  if (options_.project) options_.project(result_.values);
  if (!residuals_(result_.values, result_.residuals)) {
    result_.residuals.resize(0);
    return false;
  }
  result_.runs = 1;
  result_.cost = result_.residuals.squaredNorm();
  return true;
}

void LevenbergMarquardt::renew_jacobian() {
  if (options_.jacobian) {
    options_.jacobian(result_.values, jacobian_);
    for (Index j = 0; j < p_; ++j) jacobian_.col(j) *= search_slope(unknown(j), result_.values(j));
  } else {
    jacobian_.resize(result_.residuals.size(), p_);
    result_.runs += static_cast<int>(p_);
    parallel_for(unknowns_.size(), options_.threads, [&](std::size_t k) {
      const Index j = eigen_index(k);
      const auto column = difference_column(unknown(j), j, residuals_, result_.values, result_.residuals,
                                            options_.difference);
      if (column) {
        jacobian_.col(j) = *column;
      } else {
        jacobian_.col(j).setZero();
      }
    });
  }
  fresh_ = true;
}

/// The damped step; unknowns that it would take beyond a bound are held there, the others solve again.
VectorXd LevenbergMarquardt::bounded_step(const MatrixXd& damped, const MatrixXd& normal,
                                          const VectorXd& gradient) const {
  std::vector<bool> held(unknowns_.size(), false);
  VectorXd fixed = VectorXd::Zero(p_);
  VectorXd step;
  for (Index pass = 0; pass <= p_; ++pass) {
    MatrixXd system = damped;
    VectorXd right = -gradient - times(normal, fixed);
    for (Index j = 0; j < p_; ++j) {
      if (!held[std_index(j)]) continue;
      system.row(j).setZero();
      system.col(j).setZero();
      system(j, j) = 1.0;
      right(j) = fixed(j);
    }
    step = solve_ldlt(system, right);
    bool more = false;
    for (Index j = 0; j < p_ && step.allFinite(); ++j) {
      if (held[std_index(j)]) continue;
      const double here = to_search(unknown(j), result_.values(j));
      const double to = clamped_in_search(unknown(j), here + step(j));
      if (to == here + step(j)) continue;
      held[std_index(j)] = true;
      fixed(j) = to - here;
      more = true;
    }
    if (!more) break;
  }
  return step;
}

VectorXd LevenbergMarquardt::moved_by(const VectorXd& step, VectorXd& taken) const {
  VectorXd values(p_);
  for (Index j = 0; j < p_; ++j) {
    const SearchVariable& u = unknown(j);
    // ln(value) moves by a factor of e at most.
    const double limit = std::min(u.logarithmic ? 1.0 : 1e6, options_.max_step);
    values(j) = from_search(u, to_search(u, result_.values(j)) + std::clamp(step(j), -limit, limit));
  }
  if (options_.project) options_.project(values);
  taken.resize(p_);
  for (Index j = 0; j < p_; ++j)
    taken(j) = to_search(unknown(j), values(j)) - to_search(unknown(j), result_.values(j));
  return values;
}

LevenbergMarquardt::Trial LevenbergMarquardt::attempt(const VectorXd& values, const VectorXd& taken,
                                                      double& drop) {
  ++result_.runs;
  VectorXd residuals;
  if (!residuals_(values, residuals)) return Trial::not_runnable;
  const double cost = residuals.squaredNorm();
  if (!(cost < result_.cost)) return Trial::worse;
  const VectorXd change = residuals - result_.residuals;
  const VectorXd predicted = times(jacobian_, taken);
  const double foreseen = result_.cost - (result_.residuals + predicted).squaredNorm();
  const double ratio = foreseen > 0.0 ? (result_.cost - cost) / foreseen : 0.0;
  damping_ *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * ratio - 1.0, 3));
  damping_ = std::clamp(damping_, options_.least_damping, 1e6);
  growth_ = 2.0;
  drop = (result_.cost - cost) / std::max(result_.cost, 1e-300);
  result_.cost = cost;
  result_.values = values;
  result_.residuals = std::move(residuals);
  // Broyden: the cheapest Jacobian that explains the step just made.
  if (options_.broyden || options_.uncertainty)
    jacobian_ += (change - predicted) * taken.transpose() / taken.squaredNorm();
  fresh_ = false;
  return Trial::better;
}

LevenbergMarquardt::Progress LevenbergMarquardt::improve() {
  const MatrixXd normal = gram(jacobian_);
  const VectorXd gradient = transpose_times(jacobian_, result_.residuals);
  const double floor = 1e-12 * std::max(normal.diagonal().maxCoeff(), 1e-300);
  Progress progress;
  for (int tried = 0; tried < 8; ++tried) {
    MatrixXd damped = normal;
    for (Index j = 0; j < p_; ++j) damped(j, j) += damping_ * std::max(normal(j, j), floor) + floor;
    const VectorXd step = bounded_step(damped, normal, gradient);
    if (!step.allFinite()) {
      damping_ *= 10.0;
      continue;
    }
    VectorXd taken;
    const VectorXd values = moved_by(step, taken);
    if (!(taken.norm() > 1e-10)) break;
    const Trial trial = attempt(values, taken, progress.drop);
    failed_ = trial == Trial::not_runnable ? failed_ + 1 : 0;
    if (trial == Trial::better) {
      progress.moved = true;
      break;
    }
    damping_ *= trial == Trial::not_runnable ? 30.0 * growth_ : growth_;
    growth_ *= 2.0;
    // A stale Jacobian deserves the blame before the damping does.
    if (!fresh_ && tried >= 1) break;
  }
  return progress;
}

Termination LevenbergMarquardt::iterate() {
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    if (options_.stop && options_.stop()) return Termination::stopped;
    if (!fresh_ && rank_one_ == 0) renew_jacobian();
    const Progress progress = improve();
    if (failed_ >= kMaxFailed) return Termination::not_runnable;
    if (!progress.moved && fresh_) return Termination::step;
    const bool little = progress.moved && progress.drop < options_.cost_tolerance;
    if (little && rank_one_ == 0) return Termination::cost;
    const bool keep = options_.broyden && progress.moved && !little && progress.drop > kPayingDrop &&
                      rank_one_ < kMaxRankOne;
    rank_one_ = keep ? rank_one_ + 1 : 0;
  }
  return Termination::max_iterations;
}

/// Uncertainty, from the last Jacobian.
void LevenbergMarquardt::judge_uncertainty() {
  const VectorXd length = jacobian_.colwise().norm();
  MatrixXd scaled = jacobian_;
  for (Index j = 0; j < p_; ++j) {
    if (length(j) > 0.0) scaled.col(j) /= length(j);
  }
  const MatrixXd correlation = gram(scaled);
  const SymmetricEigen eigen = symmetric_eigen(correlation);
  const VectorXd weight = eigen.values.cwiseMax(1e-15 * eigen.values.maxCoeff()).cwiseInverse();
  const MatrixXd inverse =
      times(MatrixXd(eigen.vectors * weight.asDiagonal()), MatrixXd(eigen.vectors.transpose()));
  const double variance =
      result_.cost / std::max<double>(1.0, static_cast<double>(result_.residuals.size() - p_));
  result_.deviation.resize(p_);
  VectorXd slope(p_);
  for (Index j = 0; j < p_; ++j) {
    slope(j) = search_slope(unknown(j), result_.values(j));
    const double in_search = length(j) > 0.0 ? std::sqrt(variance * inverse(j, j)) / length(j)
                                             : std::numeric_limits<double>::infinity();
    result_.deviation(j) = in_search * slope(j);
  }
  const VectorXd per_value = slope.cwiseInverse();
  result_.gram = per_value.asDiagonal() * gram(jacobian_) * per_value.asDiagonal();
}

LeastSquaresResult LevenbergMarquardt::run() {
  if (!start()) return std::move(result_);
  if (p_ == 0) {
    result_.termination = Termination::gradient;
    return std::move(result_);
  }
  jacobian_ = MatrixXd::Zero(result_.residuals.size(), p_);
  result_.termination = iterate();
  if (options_.uncertainty) judge_uncertainty();
  return std::move(result_);
}

}  // namespace

LeastSquaresResult least_squares(const std::vector<SearchVariable>& unknowns, const Residuals& residuals,
                                 const LeastSquaresOptions& options) {
  return LevenbergMarquardt(unknowns, residuals, options).run();
}

std::vector<VectorXd> sensitivities(const std::vector<SearchVariable>& unknowns, const Residuals& residuals,
                                    const VectorXd& values, int threads) {
  constexpr double kDifference = 1e-4;
  std::vector<VectorXd> columns(unknowns.size());
  VectorXd base;
  if (!residuals(values, base)) return columns;
  parallel_for(unknowns.size(), threads, [&](std::size_t j) {
    auto column = difference_column(unknowns[j], eigen_index(j), residuals, values, base, kDifference);
    if (column) columns[j] = std::move(*column);
  });
  return columns;
}

}  // namespace bodesmith
