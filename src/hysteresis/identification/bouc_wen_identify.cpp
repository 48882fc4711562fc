#include <cmath>
#include <optional>

#include "hysteresis/bouc_wen.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

/// The search's unknowns, in units of the record: k/slope, A/slope, beta·range, gamma/beta, n, z_0/z_scale,
/// offset/y-range.
class BoucWenUnknowns {
 public:
  static constexpr Eigen::Index kCount = 7;

  BoucWenUnknowns(Range u, Range y)
      : u_(u), y_(y), slope_(y.width() / u.width()), z_scale_(0.1 * y.width()) {}

  BoucWen model(const Eigen::VectorXd& x) const {
    BoucWen out;
    out.n = x(4);
    out.k = slope_ * x(0);
    out.A = slope_ * x(1);
    out.beta = x(2) / u_.width() * std::pow(z_scale_, 1.0 - out.n);
    out.gamma = out.beta * x(3);
    out.z_0 = z_scale_ * x(5);
    out.offset = y_.low - out.k * u_.low + y_.width() * x(6);
    return out;
  }

  std::vector<ParameterUncertainty> uncertainty(const LeastSquaresResult& fit) const {
    const BoucWen found = model(fit.values);
    const double beta_unit = found.beta / fit.values(2);
    return {{"k", found.k, slope_ * fit.deviation(0)},
            {"A", found.A, slope_ * fit.deviation(1)},
            {"beta", found.beta, beta_unit * fit.deviation(2)},
            {"gamma", found.gamma, found.beta * fit.deviation(3)},
            {"n", found.n, fit.deviation(4)},
            {"z_0", found.z_0, z_scale_ * fit.deviation(5)},
            {"offset", found.offset, y_.width() * fit.deviation(6)}};
  }

 private:
  Range u_;
  Range y_;
  double slope_;
  double z_scale_;
};

/// From six starts with n = 1 (in closed form), then with n free where that is asked for.
LeastSquaresResult search_bouc_wen(const BoucWenUnknowns& unknowns, std::span<const TimeRecord> records,
                                   double skip_s, bool free_n) {
  Eigen::VectorXd lower(BoucWenUnknowns::kCount), upper(BoucWenUnknowns::kCount),
      typical(BoucWenUnknowns::kCount), start(BoucWenUnknowns::kCount);
  lower << 0.1, 0.01, 0.05, -0.95, 1.0, -20.0, -10.0;
  upper << 10.0, 8.0, 200.0, 1.0, 4.0, 20.0, 10.0;
  typical << 1.0, 1.0, 1.0, 0.5, 0.5, 1.0, 0.1;
  const auto residual = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    operator_residual(BoucWenOperator(unknowns.model(x)), records, skip_s, r);
  };
  Eigen::VectorXd upper_of_one = upper;
  upper_of_one(4) = 1.0;
  std::optional<LeastSquaresResult> best;
  for (const double beta : {2.0, 8.0}) {
    for (const double side : {-1.0, 0.0, 1.0}) {
      start << 1.2, 0.4, beta, 0.2, 1.0, side, 0.0;
      LeastSquaresResult fit = fit_parameters(residual, start, lower, upper_of_one, typical, 60);
      if (!best || fit.cost < best->cost) best = std::move(fit);
    }
  }
  if (!free_n) return *best;
  LeastSquaresResult fit = fit_parameters(residual, best->values, lower, upper, typical, 60);
  return fit.cost < best->cost * 0.999 ? fit : *best;
}

}  // namespace

Identified identify_bouc_wen(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const BoucWenUnknowns unknowns(swept_range(records), output_range(records, options.skip_s));
  const bool free_n = !options.as_in_paper();
  const LeastSquaresResult best = search_bouc_wen(unknowns, records, options.skip_s, free_n);
  const BoucWen model = unknowns.model(best.values);
  Identified out;
  out.method = free_n ? "bounded nonlinear least squares from six starts, exponent n free"
                      : "bounded nonlinear least squares from six starts, n = 1";
  out.converged = converged(best.termination);
  out.uncertainty = unknowns.uncertainty(best);
  out.model = make_model("bouc_wen", Parameters()
                                         .set("k", model.k)
                                         .set("A", model.A)
                                         .set("beta", model.beta)
                                         .set("gamma", model.gamma)
                                         .set("n", model.n)
                                         .set("z_0", model.z_0)
                                         .set("offset", model.offset));
  return out;
}

}  // namespace bodesmith::hysteresis
