#include "gap/model/model_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search_options.hpp"
#include "numeric/index.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// `edges_held`: what moves edges across samples stays as it is.
std::vector<SearchVariable> search_variables(const std::vector<Unknown>& unknowns, bool edges_held = false) {
  std::vector<SearchVariable> out;
  for (const Unknown& u : unknowns) {
    const bool held = edges_held && u.moves_edges();
    out.push_back({u.value, held ? u.value : u.low, held ? u.value : u.high, u.logarithmic, u.scale});
  }
  return out;
}

Residuals residuals_by(Runner& runner) {
  return [&runner](const Eigen::VectorXd& values, Eigen::VectorXd& out) {
    std::vector<double> r;
    if (!runner({values.data(), std_index(values.size())}, r)) return false;
    out = as_eigen(r);
    return true;
  };
}

}  // namespace

FittedModel fit(Model model, const Experiments& experiments, LeastSquaresOptions options) {
  Runner runner(model, experiments);
  options.threads = allowed_threads();
  const auto unknowns = model.unknowns();
  std::vector<std::size_t> known;
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    if (unknowns[k].given_spread > 0.0) known.push_back(k);
  }
  double unit = 0.0;
  std::vector<double> first;
  if (runner(model.values(), first)) unit = rms(first);
  const auto of_records = residuals_by(runner);
  const auto residuals = [&](const Eigen::VectorXd& v, Eigen::VectorXd& out) {
    if (!of_records(v, out)) return false;
    const Eigen::Index n = out.size();
    out.conservativeResize(n + eigen_index(known.size()));
    for (std::size_t i = 0; i < known.size(); ++i) {
      out(n + eigen_index(i)) = unit * unknowns[known[i]].deviations(v(eigen_index(known[i])));
    }
    return true;
  };
  FittedModel fitted{std::move(model), {}};
  // An edge on a sample (a clock of which the sampling is a multiple) jumps where a difference would tell a slope, and no step of all together
  // leaves less: the others come first.
  bool edges_held = std::ranges::any_of(unknowns, &Unknown::moves_edges);
  for (;;) {
    auto& result = fitted.result;
    result = least_squares(search_variables(fitted.model.unknowns(), edges_held), residuals, options);
    if (!fitted.usable()) break;
    fitted.model.set_values(to_vector(result.values));
    result.residuals.conservativeResize(result.residuals.size() - eigen_index(known.size()));
    fitted.rms = rms(to_vector(result.residuals));
    if (std::exchange(edges_held, false)) continue;
    if (known.empty() || !(kFarMore * fitted.rms < unit) || (options.stop && options.stop())) break;
    unit = fitted.rms;
  }
  return fitted;
}

LeastSquaresResult held_by(const Model& model, const Experiments& experiments) {
  Runner runner(model, experiments);
  LeastSquaresOptions options;
  options.threads = allowed_threads();
  options.max_iterations = 1;
  return least_squares(search_variables(model.unknowns()), residuals_by(runner), options);
}

Eigen::MatrixXd sensitivities(const Model& model, const Experiments& experiments) {
  Runner runner(model, experiments);
  const auto columns = bodesmith::sensitivities(search_variables(model.unknowns()), residuals_by(runner),
                                                as_eigen(model.values()), allowed_threads());
  Eigen::Index rows = 0;
  for (const auto& column : columns) rows = std::max(rows, column.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, eigen_index(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k].size() == rows) all.col(eigen_index(k)) = columns[k];
  }
  return all;
}

}  // namespace bodesmith::gap
