#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/prandtl_ishlinskii.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

const std::vector<ParameterInfo>& infos() {
  static const std::vector<ParameterInfo> list = {
      array("r", "u", "thresholds of the plays, 0 = r[0] < r[1] < …", 0.0),
      array("w", "y/u", "weights of the plays; w[0] > 0 and every partial sum above 0"),
      optional(array("s", "y", "thresholds of the one-sided dead zones (asymmetry)"), {}),
      optional(array("v", "1", "weights of the dead zones, 1 + their sum on either side > 0"), {}),
      optional(array("gamma", "1", "[c0, c1, c2, c3] of the envelope c0 tanh(c1 x + c2) + c3"), {}),
      optional(scalar("u_0", "u", "input at which the virgin curve starts"), {0.0}),
      optional(scalar("offset", "y", "constant added at the output"), {0.0}),
      word("start", "the past that a reset assumes", {"rest_zero", "from_above", "from_below"}),
  };
  return list;
}

void check(const Parameters& values) {
  (void)PrandtlIshlinskii::from(values);
}

std::unique_ptr<Operator> make(const Parameters& values) {
  return std::make_unique<PrandtlIshlinskiiOperator>(PrandtlIshlinskii::from(values));
}

std::unique_ptr<Inverse> make_inverse_of(const Parameters& values) {
  return std::make_unique<PrandtlIshlinskiiInverse>(PrandtlIshlinskii::from(values));
}

Parameters to_parameters(const PrandtlIshlinskii& model) {
  Parameters out;
  const char* start = model.start == PrandtlIshlinskii::Start::rest_zero    ? "rest_zero"
                      : model.start == PrandtlIshlinskii::Start::from_above ? "from_above"
                                                                            : "from_below";
  out.set("r", model.r).set("w", model.w).set("s", model.s).set("v", model.v).set("gamma", model.gamma);
  out.set("u_0", model.u_0).set("offset", model.offset).set("start", start);
  return out;
}

struct Linear {
  PrandtlIshlinskii model;
  double cost = 0.0;
  Eigen::VectorXd deviation;  ///< of w…, offset
  bool converged = true;
};

/// The bank's weights and the offset for one assumed past: convex.
Linear fit_bank(std::span<const TimeRecord> records, const IdentifyOptions& options,
                PrandtlIshlinskii model) {
  const auto n = static_cast<Eigen::Index>(model.r.size());
  model.w.assign(model.r.size(), 1.0);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n + 1);
  Eigen::VectorXd row(n + 1);
  const double middle = output_range(records, options.skip_s).middle();
  const auto visit = [&](auto&& use) {
    for (const TimeRecord& record : records) {
      PrandtlIshlinskiiOperator bank(model);
      const std::size_t first = first_counted(record, options.skip_s);
      for (std::size_t i = 0; i < record.size(); ++i) {
        if (i == 0) {
          bank.reset(record.u[0]);
        } else {
          bank.step(record.u[i], record.step_s);
        }
        if (i < first) continue;
        for (Eigen::Index k = 0; k < n; ++k) row(k) = bank.states()[static_cast<std::size_t>(k)];
        row(n) = 1.0;
        use(record.y[i] - middle);
      }
    }
  };
  visit([&](double y) {
    gram.selfadjointView<Eigen::Lower>().rankUpdate(row);
    rhs += y * row;
  });
  gram = gram.selfadjointView<Eigen::Lower>();
  std::vector<bool> free_sign(static_cast<std::size_t>(n) + 1, false);
  free_sign.back() = true;
  const NnlsResult solved = nnls(gram, rhs, free_sign);
  Linear out;
  out.converged = solved.converged;
  std::vector<double> residual;
  visit([&](double y) { residual.push_back(row.dot(solved.x) - y); });
  const Eigen::Map<const Eigen::VectorXd> map(residual.data(), static_cast<Eigen::Index>(residual.size()));
  out.cost = map.squaredNorm();
  // Weights at their bound 0 are not estimated: the deviations are those of the others.
  std::vector<Eigen::Index> open;
  for (Eigen::Index k = 0; k <= n; ++k)
    if (k == n || solved.x(k) > 0.0) open.push_back(k);
  Eigen::MatrixXd sub(open.size(), open.size());
  for (std::size_t a = 0; a < open.size(); ++a)
    for (std::size_t b = 0; b < open.size(); ++b)
      sub(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = gram(open[a], open[b]);
  const Eigen::VectorXd deviation = parameter_deviation(sub, map);
  out.deviation = Eigen::VectorXd::Zero(n + 1);
  for (std::size_t a = 0; a < open.size(); ++a)
    out.deviation(open[a]) = deviation(static_cast<Eigen::Index>(a));
  out.model = std::move(model);
  for (Eigen::Index k = 0; k < n; ++k) out.model.w[static_cast<std::size_t>(k)] = solved.x(k);
  // Without a linear part there is no inverse; a thousandth of the whole is far below what a record shows.
  double total = 0.0;
  for (const double w : out.model.w) total += w;
  out.model.w[0] = std::max(out.model.w[0], 1e-3 * std::max(total, 1e-300));
  out.model.offset = solved.x(n) + middle;
  return out;
}

/// Output error over w, the dead zones' weights and the offset.
void refine_asymmetric(std::span<const TimeRecord> records, const IdentifyOptions& options, Linear& fit,
                       std::vector<ParameterUncertainty>& uncertainty) {
  PrandtlIshlinskii& model = fit.model;
  // The dead zones act on the bank's output, measured from its middle: the offset inside the bank moves
  // there.
  Range bank;
  for (const TimeRecord& record : records) {
    PrandtlIshlinskii plain = model;
    plain.offset = 0.0;
    PrandtlIshlinskiiOperator op(plain);
    bank.include(op.reset(record.u[0]));
    for (const double u : record.u) bank.include(op.step(u, 0.0));
  }
  for (const double part : {0.2, 0.4, 0.6, 0.8}) {
    const double knee = bank.low + part * bank.width();
    if (std::abs(knee) < 1e-9 * bank.width()) continue;
    model.s.push_back(knee);
    model.v.push_back(0.0);
  }
  const auto n = static_cast<Eigen::Index>(model.w.size());
  const auto m = static_cast<Eigen::Index>(model.s.size());
  Eigen::VectorXd start(n + m + 1);
  Eigen::VectorXd lower(n + m + 1);
  Eigen::VectorXd typical(n + m + 1);
  double total = 0.0;
  for (const double w : model.w) total += w;
  for (Eigen::Index k = 0; k < n; ++k) {
    start(k) = model.w[static_cast<std::size_t>(k)];
    lower(k) = k == 0 ? 1e-3 * total : 0.0;
    typical(k) = total / static_cast<double>(n);
  }
  for (Eigen::Index k = 0; k < m; ++k) {
    start(n + k) = 0.0;
    lower(n + k) = -0.2;
    typical(n + k) = 0.1;
  }
  start(n + m) = model.offset;
  lower(n + m) = -std::numeric_limits<double>::infinity();
  typical(n + m) = bank.width();
  const Eigen::VectorXd upper = Eigen::VectorXd::Constant(n + m + 1, std::numeric_limits<double>::infinity());
  const auto put = [&](const Eigen::VectorXd& x) {
    PrandtlIshlinskii out = model;
    for (Eigen::Index k = 0; k < n; ++k) out.w[static_cast<std::size_t>(k)] = x(k);
    for (Eigen::Index k = 0; k < m; ++k) out.v[static_cast<std::size_t>(k)] = x(n + k);
    out.offset = x(n + m);
    return out;
  };
  const LeastSquaresResult solved = least_squares(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& residual) {
        operator_residual(PrandtlIshlinskiiOperator(put(x)), records, options.skip_s, residual);
      },
      start, lower, upper, typical, 40);
  model = put(solved.x);
  fit.cost = solved.cost;
  fit.converged = fit.converged && solved.converged;
  uncertainty.clear();
  for (Eigen::Index k = 0; k < n; ++k)
    uncertainty.push_back({fmt::format("w[{}]", k), solved.x(k), solved.deviation(k)});
  for (Eigen::Index k = 0; k < m; ++k)
    uncertainty.push_back({fmt::format("v[{}]", k), solved.x(n + k), solved.deviation(n + k)});
  uncertainty.push_back({"offset", solved.x(n + m), solved.deviation(n + m)});
}

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  const Range range = input_range(records, 0.0);
  if (!(range.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  const int size = options.size > 0 ? options.size : 10;
  PrandtlIshlinskii model;
  model.u_0 = records[0].u[0];
  for (int i = 0; i < size; ++i) model.r.push_back(0.5 * range.width() * i / size);
  std::optional<Linear> best;
  using Start = PrandtlIshlinskii::Start;
  for (const Start past : {Start::rest_zero, Start::from_above, Start::from_below}) {
    model.start = past;
    Linear fit = fit_bank(records, options, model);
    if (!best || fit.cost < best->cost * (1.0 - 1e-9)) best = std::move(fit);
  }
  Identified out;
  for (std::size_t k = 0; k < best->model.w.size(); ++k)
    out.uncertainty.push_back(
        {fmt::format("w[{}]", k), best->model.w[k], best->deviation(static_cast<Eigen::Index>(k))});
  out.uncertainty.push_back({"offset", best->model.offset, best->deviation(best->deviation.size() - 1)});
  out.method = fmt::format("non-negative least squares of {} play weights (convex)", size);
  if (options.asymmetric) {
    refine_asymmetric(records, options, *best, out.uncertainty);
    out.method += ", then weights and dead zones by bounded nonlinear least squares";
    out.notes.push_back(
        "dead zones learn the asymmetry of the amplitudes in the record only: check a holdout of other "
        "amplitudes");
  }
  out.converged = best->converged;
  out.stage.model = checked_model("prandtl_ishlinskii", to_parameters(best->model));
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace

ModelType prandtl_ishlinskii_type() {
  return {"prandtl_ishlinskii",
          "weighted plays, optionally with dead zones (asymmetry) and an envelope; analytic inverse",
          "Kuhnen 2003; Al Janaideh, Rakheja, Su 2011",
          infos(),
          check,
          make,
          make_inverse_of,
          identify};
}

}  // namespace bodesmith::hysteresis
