#include "gap/search/folds.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "gap/least_squares.hpp"
#include "gap/runner.hpp"
#include "numeric/dense.hpp"
#include "numeric/index.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFolds = 5;
/// Keeps values that a fold's rest does not determine where they are (of the normal matrix' diagonal).
constexpr double kFoldRidge = 1e-6;
/// Values move by this much of the search's scale at most: beyond, Gauss-Newton means nothing.
constexpr double kMaxMove = 0.5;
/// A record leaves the model's values open when folds leave this much more than the fit.
constexpr double kOpen = 1.2;

/// Fold of every residual.
std::vector<std::size_t> fold_of_each(const Experiments& train, Folds folds) {
  std::vector<std::size_t> fold;
  for (std::size_t k = 0; k < train.size(); ++k) {
    const bool response = std::holds_alternative<FrequencyExperiment>(train[k]);
    const std::size_t n = std::visit([](const auto& record) { return record.scored(); }, train[k]);
    for (std::size_t i = 0; i < n; ++i)
      fold.push_back(folds == Folds::records ? k : response ? i / 2 % kFolds : i * kFolds / n);
  }
  return fold;
}

double search_scale(const Unknown& u) {
  return u.logarithmic ? 1.0 : u.scale;
}

}  // namespace

std::vector<double> folded_residuals(const Model& model, const Experiments& train, Folds kind) {
  Runners runner(model, train);
  const auto values = current_values(model);
  std::vector<double> residuals;
  if (!runner(values, residuals)) return {};
  const auto unknowns = model.unknowns();
  const auto columns = sensitivities(
      unknowns, [&](std::span<const double> v, std::vector<double>& out) { return runner(v, out); }, values,
      runner.threads());
  // Unknowns at a bound stay there; those that change nothing have nothing to say.
  std::vector<std::size_t> counted;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    if (columns[j].size() == residuals.size() && !unknowns[j].at_bound() && rms(columns[j]) > 0.0)
      counted.push_back(j);
  }
  if (counted.empty()) return residuals;
  const auto p = eigen_index(counted.size());
  const auto n = eigen_index(residuals.size());
  MatrixXd jacobian(n, p);
  VectorXd known = VectorXd::Zero(p);
  const double unit = rms(residuals);
  for (Index j = 0; j < p; ++j) {
    const auto& u = unknowns[counted[std_index(j)]];
    jacobian.col(j) = as_eigen(columns[counted[std_index(j)]]);
    if (u.given_spread > 0.0) known(j) = std::pow(unit * search_scale(u) / u.given_spread, 2);
  }
  const auto fold = fold_of_each(train, kind);
  const std::size_t folds = fold.empty() ? 0 : *std::max_element(fold.begin(), fold.end()) + 1;
  std::vector<MatrixXd> normal(folds, MatrixXd::Zero(p, p));
  std::vector<VectorXd> gradient(folds, VectorXd::Zero(p));
  for (Index i = 0; i < n; ++i) {
    const auto k = fold[std_index(i)];
    for (Index a = 0; a < p; ++a) {
      gradient[k](a) += jacobian(i, a) * residuals[std_index(i)];
      for (Index b = 0; b <= a; ++b) normal[k](a, b) += jacobian(i, a) * jacobian(i, b);
    }
  }
  MatrixXd whole = MatrixXd::Zero(p, p);
  VectorXd slope = VectorXd::Zero(p);
  for (std::size_t k = 0; k < folds; ++k) {
    for (Index a = 0; a < p; ++a) {
      for (Index b = 0; b < a; ++b) normal[k](b, a) = normal[k](a, b);
    }
    whole += normal[k];
    slope += gradient[k];
  }
  std::vector<VectorXd> moved;
  for (std::size_t k = 0; k < folds; ++k) {
    MatrixXd rest = whole - normal[k];
    for (Index a = 0; a < p; ++a) rest(a, a) += known(a) + kFoldRidge * whole(a, a);
    // What the whole fit leaves of the slope (a fit that was cut short) is not the fold's doing.
    VectorXd move = solve_ldlt(rest, VectorXd(gradient[k] - slope * (1.0 / static_cast<double>(folds))));
    for (Index a = 0; a < p; ++a) {
      if (!std::isfinite(move(a))) move(a) = 0.0;
      move(a) = std::clamp(move(a), -kMaxMove, kMaxMove);
    }
    moved.push_back(std::move(move));
  }
  for (Index i = 0; i < n; ++i) {
    const auto& move = moved[fold[std_index(i)]];
    for (Index a = 0; a < p; ++a) residuals[std_index(i)] += jacobian(i, a) * move(a);
  }
  return residuals;
}

Folds suitable_folds(const Model& model, const Experiments& train) {
  if (train.size() < 2) return Folds::stretches;
  const auto residuals = residuals_of(model, train);
  const auto folds = folded_residuals(model, train, Folds::records);
  return rms(folds) > kOpen * rms(residuals) ? Folds::stretches : Folds::records;
}

}  // namespace bodesmith::gap
