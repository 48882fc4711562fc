#include "gap/model/least_squares.hpp"

#include <cmath>

#include "numeric/index.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::gap {
namespace {

std::vector<SearchVariable> search_variables(const std::vector<Unknown>& unknowns) {
  std::vector<SearchVariable> out;
  for (const Unknown& u : unknowns) out.push_back({u.value, u.low, u.high, u.logarithmic, u.scale});
  return out;
}

bodesmith::Residuals on_vectors(const Residuals& residuals) {
  return [&residuals](const Eigen::VectorXd& values, Eigen::VectorXd& out) {
    std::vector<double> r;
    if (!residuals({values.data(), std_index(values.size())}, r)) return false;
    out = as_eigen(r);
    return true;
  };
}

}  // namespace

std::vector<std::vector<double>> sensitivities(const std::vector<Unknown>& unknowns,
                                               const Residuals& residuals, const std::vector<double>& at,
                                               int threads) {
  std::vector<std::vector<double>> columns;
  for (const Eigen::VectorXd& column :
       bodesmith::sensitivities(search_variables(unknowns), on_vectors(residuals), as_eigen(at), threads))
    columns.push_back(to_vector(column));
  return columns;
}

LeastSquaresResult least_squares(const std::vector<Unknown>& unknowns, const Residuals& residuals,
                                 const LeastSquaresOptions& options) {
  const bodesmith::LeastSquaresResult found =
      bodesmith::least_squares(search_variables(unknowns), on_vectors(residuals),
                               {.max_iterations = options.iterations,
                                .cost_tolerance = options.cost_tolerance,
                                .stop = options.stop,
                                .threads = options.threads});
  LeastSquaresResult out;
  out.values = to_vector(found.values);
  out.residuals = to_vector(found.residuals);
  out.termination = found.termination;
  out.runs = found.runs;
  const double n = static_cast<double>(found.residuals.size());
  out.rms = n > 0.0 ? std::sqrt(found.cost / n) : 0.0;
  out.deviation = to_vector(found.deviation);
  out.condition_number = found.condition_number;
  return out;
}

}  // namespace bodesmith::gap
