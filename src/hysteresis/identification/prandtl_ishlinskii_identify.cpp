#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "hysteresis/prandtl_ishlinskii.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/bounded_least_squares.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

/// Of the largest: what a squared column holds less is rounding.
constexpr double kLeastAxis = 1e-14;

struct BankFit {
  PrandtlIshlinskii model;
  double cost = 0.0;
  Eigen::VectorXd deviation;  ///< of w…, offset
  bool converged = true;      ///< of weights alone always: their minimum is found, not approached
};

/// min |A x - y|² from AᵀA and Aᵀy, the last unknown free, the others not below 0.
Eigen::VectorXd solve_non_negative(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs) {
  const Eigen::Index n = rhs.size() - 1;
  // The free one follows the others: what is left of their columns without its column decides.
  const Eigen::VectorXd shared = gram.col(n).head(n) / gram(n, n);
  const SymmetricEigen axes = symmetric_eigen(gram.topLeftCorner(n, n) - shared * gram.row(n).head(n));
  const Eigen::VectorXd along = transpose_times(axes.vectors, rhs.head(n) - shared * rhs(n));
  LongMatrix a;
  LongVector b;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(axes.values(i) > kLeastAxis * axes.values(n - 1))) continue;
    const double length = std::sqrt(axes.values(i));
    const Eigen::VectorXd row = length * axes.vectors.col(i);
    a.emplace_back(row.begin(), row.end());
    b.push_back(along(i) / length);
  }
  const LongVector found = bounded_least_squares(a, b, 0.0L, std::numeric_limits<long double>::infinity()).x;
  Eigen::VectorXd x(n + 1);
  std::copy(found.begin(), found.end(), x.begin());
  x(n) = rhs(n) / gram(n, n) - shared.dot(x.head(n));
  return x;
}

/// Of a linear least-squares solution with some unknowns held at 0: those are not estimated.
Eigen::VectorXd deviation_of_free(const Eigen::MatrixXd& gram, const std::vector<Eigen::Index>& free,
                                  const Eigen::VectorXd& residual) {
  const Eigen::VectorXd deviation = parameter_deviation(gram(free, free), residual);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(gram.rows());
  out(free) = deviation;
  return out;
}

/// The bank's weights and the offset for one assumed past: convex.
BankFit fit_bank(std::span<const TimeRecord> records, double skip_s, PrandtlIshlinskii model) {
  const Eigen::Index n = eigen_index(model.r.size());
  model.w.assign(model.r.size(), 1.0);
  const double middle = output_range(records, skip_s).middle();
  // Rows of the system: the plays' states and 1.
  Eigen::VectorXd row(n + 1);
  row(n) = 1.0;
  const auto visit = [&](auto&& use) {
    PrandtlIshlinskiiOperator bank(model);
    drive(bank, records, skip_s, [&](double, const TimeRecord& record, std::size_t i) {
      row.head(n) = as_eigen(bank.states());
      use(record.y[i] - middle);
    });
  };
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n + 1);
  visit([&](double y) {
    gram.selfadjointView<Eigen::Lower>().rankUpdate(row);
    rhs += y * row;
  });
  gram = gram.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd x = solve_non_negative(gram, rhs);
  std::vector<double> residual;
  visit([&](double y) { residual.push_back(row.dot(x) - y); });
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k <= n; ++k)
    if (k == n || x(k) > 0.0) free.push_back(k);
  BankFit out;
  out.cost = as_eigen(residual).squaredNorm();
  out.deviation = deviation_of_free(gram, free, as_eigen(residual));
  model.w = to_vector(x.head(n));
  // Without a linear part there is no inverse; a thousandth of the whole is far below what a record shows.
  const double total = std::accumulate(model.w.begin(), model.w.end(), 0.0);
  model.w[0] = std::max(model.w[0], 1e-3 * std::max(total, 1e-300));
  model.offset = x(n) + middle;
  out.model = std::move(model);
  return out;
}

/// What the bank alone puts out over the records.
Range bank_output(std::span<const TimeRecord> records, PrandtlIshlinskii model) {
  model.offset = 0.0;
  Range out;
  for (const TimeRecord& record : records) {
    PrandtlIshlinskiiOperator op(model);
    out.include(op.reset(record.u[0]));
    for (const double u : record.u) out.include(op.step(u, 0.0));
  }
  return out;
}

/// Output error over w, the dead zones' weights and the offset.
void refine_asymmetric(std::span<const TimeRecord> records, double skip_s, BankFit& fit,
                       std::vector<ParameterUncertainty>& uncertainty) {
  PrandtlIshlinskii& model = fit.model;
  // The dead zones act on the bank's output, measured from its middle: the offset inside the bank moves
  // there.
  const Range bank = bank_output(records, model);
  for (const double part : {0.2, 0.4, 0.6, 0.8}) {
    const double knee = bank.low + part * bank.width();
    if (std::abs(knee) < 1e-9 * bank.width()) continue;
    model.s.push_back(knee);
    model.v.push_back(0.0);
  }
  const Eigen::Index n = eigen_index(model.w.size());
  const Eigen::Index m = eigen_index(model.s.size());
  const double total = std::accumulate(model.w.begin(), model.w.end(), 0.0);
  const double infinite = std::numeric_limits<double>::infinity();
  Eigen::VectorXd start(n + m + 1), lower(n + m + 1), typical(n + m + 1);
  start << as_eigen(model.w), Eigen::VectorXd::Zero(m), model.offset;
  lower << 1e-3 * total, Eigen::VectorXd::Zero(n - 1), Eigen::VectorXd::Constant(m, -0.2), -infinite;
  typical << Eigen::VectorXd::Constant(n, total / static_cast<double>(n)), Eigen::VectorXd::Constant(m, 0.1),
      bank.width();
  const auto put = [&](const Eigen::VectorXd& x) {
    PrandtlIshlinskii out = model;
    as_eigen(out.w) = x.head(n);
    as_eigen(out.v) = x.segment(n, m);
    out.offset = x(n + m);
    return out;
  };
  const LeastSquaresResult solved = fit_parameters(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& residual) {
        operator_residual(PrandtlIshlinskiiOperator(put(x)), records, skip_s, residual);
      },
      start, lower, Eigen::VectorXd::Constant(n + m + 1, infinite), typical, 40);
  model = put(solved.values);
  fit.cost = solved.cost;
  fit.converged = converged(solved.termination);
  uncertainty.clear();
  add_uncertainty(uncertainty, "w", solved.values, solved.deviation, 0, n);
  add_uncertainty(uncertainty, "v", solved.values, solved.deviation, n, m);
  uncertainty.push_back({"offset", solved.values(n + m), solved.deviation(n + m)});
}

}  // namespace

Identified identify_prandtl_ishlinskii(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const double span = swept_range(records).width();
  const int size = options.size > 0 ? options.size : 10;
  PrandtlIshlinskii model;
  model.u_0 = records[0].u[0];
  for (int i = 0; i < size; ++i) model.r.push_back(0.5 * span * i / size);
  std::optional<BankFit> best;
  using Start = PrandtlIshlinskii::Start;
  for (const Start past : {Start::rest_zero, Start::from_above, Start::from_below}) {
    model.start = past;
    BankFit fit = fit_bank(records, options.skip_s, model);
    if (!best || fit.cost < best->cost * (1.0 - 1e-9)) best = std::move(fit);
  }
  Identified out;
  add_uncertainty(out.uncertainty, "w", as_eigen(best->model.w), best->deviation, 0, size);
  out.uncertainty.push_back({"offset", best->model.offset, best->deviation(size)});
  out.method = fmt::format("non-negative least squares of {} play weights (convex)", size);
  if (options.asymmetric) {
    refine_asymmetric(records, options.skip_s, *best, out.uncertainty);
    out.method += ", then weights and dead zones by bounded nonlinear least squares";
    out.notes.push_back(
        "dead zones learn the asymmetry of the amplitudes in the record only: check a holdout of other "
        "amplitudes");
  }
  out.converged = best->converged;
  const PrandtlIshlinskii& found = best->model;
  out.model = make_model("prandtl_ishlinskii", Parameters()
                                                   .set("r", found.r)
                                                   .set("w", found.w)
                                                   .set("s", found.s)
                                                   .set("v", found.v)
                                                   .set("gamma", found.gamma)
                                                   .set("u_0", found.u_0)
                                                   .set("offset", found.offset)
                                                   .set("start", to_string(found.start)));
  return out;
}

}  // namespace bodesmith::hysteresis
