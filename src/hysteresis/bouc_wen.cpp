#include "hysteresis/bouc_wen.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {

BoucWen BoucWen::from(const Parameters& values) {
  BoucWen out;
  out.k = values.scalar("k");
  out.A = values.scalar("A");
  out.beta = values.scalar("beta");
  out.gamma = values.scalar("gamma");
  out.n = values.scalar("n");
  out.z_0 = values.scalar("z_0");
  out.offset = values.scalar("offset");
  if (!(std::abs(out.gamma) <= out.beta))
    throw DesignError("gamma is outside [-beta, beta]: the state would grow without bound");
  return out;
}

double BoucWen::advance(double z, double du) const {
  if (du == 0.0) return z;
  const double direction = du > 0.0 ? 1.0 : -1.0;
  double left = std::abs(du);
  if (n == 1.0) {
    // dz/ds = direction·A − c z in s = |u − u₀|, where c depends on the sign of z: at most one crossing of 0.
    for (int piece = 0; piece < 2 && left > 0.0; ++piece) {
      // Sign of z along the piece: z's own, or where it is 0 the way it is driven.
      const double sign = z != 0.0 ? (z > 0.0 ? 1.0 : -1.0) : (A * direction >= 0.0 ? 1.0 : -1.0);
      const double c = beta + gamma * direction * sign;  // ≥ 0
      const double drive = A * direction;
      const auto at = [&](double s) {
        return c > 0.0 ? drive / c + (z - drive / c) * std::exp(-c * s) : z + drive * s;
      };
      if (z != 0.0 && drive * z < 0.0) {
        // Falls to 0 within: z = drive/c (1 − e^{cs}).
        const double crossing = c > 0.0 ? std::log1p(-c * z / drive) / c : -z / drive;
        if (crossing < left) {
          left -= crossing;
          z = 0.0;
          continue;
        }
      }
      return at(left);
    }
    return z;
  }
  const auto slope = [&](double value) {
    const double size = std::abs(value);
    const double power = std::pow(size, n);
    return direction * A - beta * (value >= 0.0 ? power : -power) - gamma * direction * power;
  };
  while (left > 0.0) {
    const double size = std::max(std::abs(z), std::pow(std::abs(A) / (beta + std::abs(gamma)), 1.0 / n));
    const double stiffness = (beta + std::abs(gamma)) * n * std::pow(size, n - 1.0);
    const double h = std::min(left, stiffness > 0.0 ? 0.05 / stiffness : left);
    const double k1 = slope(z);
    const double k2 = slope(z + 0.5 * h * k1);
    const double k3 = slope(z + 0.5 * h * k2);
    const double k4 = slope(z + h * k3);
    z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    left -= h;
    if (left < 1e-15 * std::abs(du)) break;
  }
  return z;
}

namespace {

const std::vector<ParameterInfo>& infos() {
  static const std::vector<ParameterInfo> list = {
      scalar("k", "y/u", "slope without hysteresis"),
      scalar("A", "y/u", "slope with which the hysteretic part starts"),
      scalar("beta", "u^-1 y^(1-n)", "width of the loop", 1e-300),
      scalar("gamma", "u^-1 y^(1-n)", "shape of the loop, within ±beta"),
      optional(scalar("n", "1", "sharpness of the corner", 1.0, 50.0), {1.0}),
      optional(scalar("z_0", "y", "hysteretic part that a reset assumes"), {0.0}),
      optional(scalar("offset", "y", "constant added at the output"), {0.0}),
  };
  return list;
}

void check(const Parameters& values) {
  (void)BoucWen::from(values);
}

std::unique_ptr<Operator> make(const Parameters& values) {
  return std::make_unique<BoucWenOperator>(BoucWen::from(values));
}

/// Rises where k exceeds the steepest dz/du, which over the bounded states is max(A, −A + …): at a reversal
/// from saturation |z| = (A/(beta+gamma))^(1/n) it is A (1 + (beta − gamma)/(beta + gamma)).
std::unique_ptr<Inverse> make_inverse_of(const Parameters& values) {
  const BoucWen model = BoucWen::from(values);
  const double steepest =
      model.A >= 0.0
          ? model.A *
                (1.0 + std::max(0.0, (model.beta - model.gamma) / std::max(model.beta + model.gamma, 1e-300)))
          : 0.0;
  if (!(model.k > steepest))
    throw DesignError(
        "k is not above the steepest slope of the hysteretic part: the output does not always rise with the "
        "input, there is no inverse");
  return std::make_unique<BracketingInverse>(std::make_unique<BoucWenOperator>(model), -1e12, 1e12);
}

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  const Range u = input_range(records, 0.0);
  const Range y = output_range(records, options.skip_s);
  if (!(u.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  const double slope = y.width() / u.width();
  const double z_scale = 0.1 * y.width();
  // In units of the record: k/slope, A/slope, beta·range, gamma/beta, n, z_0/z_scale, offset/y-range.
  const auto put = [&](const Eigen::VectorXd& x) {
    BoucWen model;
    model.n = x(4);
    model.k = slope * x(0);
    model.A = slope * x(1);
    model.beta = x(2) / u.width() * std::pow(z_scale, 1.0 - model.n);
    model.gamma = model.beta * x(3);
    model.z_0 = z_scale * x(5);
    model.offset = y.low - model.k * u.low + y.width() * x(6);
    return model;
  };
  Eigen::VectorXd lower(7), upper(7), typical(7);
  lower << 0.1, 0.01, 0.05, -0.95, 1.0, -20.0, -10.0;
  upper << 10.0, 8.0, 200.0, 1.0, 4.0, 20.0, 10.0;
  typical << 1.0, 1.0, 1.0, 0.5, 0.5, 1.0, 0.1;
  std::optional<LeastSquaresResult> best;
  bool free_n = options.method != "paper";
  for (const double beta : {2.0, 8.0}) {
    for (const double side : {-1.0, 0.0, 1.0}) {
      Eigen::VectorXd start(7);
      start << 1.2, 0.4, beta, 0.2, 1.0, side, 0.0;
      Eigen::VectorXd high = upper;
      high(4) = 1.0;  // first with n = 1, in closed form
      const auto residual = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
        operator_residual(BoucWenOperator(put(x)), records, options.skip_s, r);
      };
      LeastSquaresResult fit = least_squares(residual, start, lower, high, typical, 60);
      if (!best || fit.cost < best->cost) best = std::move(fit);
    }
  }
  if (free_n) {
    LeastSquaresResult fit = least_squares(
        [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
          operator_residual(BoucWenOperator(put(x)), records, options.skip_s, r);
        },
        best->x, lower, upper, typical, 60);
    if (fit.cost < best->cost * 0.999) best = std::move(fit);
  }
  const BoucWen model = put(best->x);
  Identified out;
  out.method = free_n ? "bounded nonlinear least squares from six starts, exponent n free"
                      : "bounded nonlinear least squares from six starts, n = 1";
  out.converged = best->converged;
  const double beta_unit = model.beta / best->x(2);
  out.uncertainty = {{"k", model.k, slope * best->deviation(0)},
                     {"A", model.A, slope * best->deviation(1)},
                     {"beta", model.beta, beta_unit * best->deviation(2)},
                     {"gamma", model.gamma, model.beta * best->deviation(3)},
                     {"n", model.n, best->deviation(4)},
                     {"z_0", model.z_0, z_scale * best->deviation(5)},
                     {"offset", model.offset, y.width() * best->deviation(6)}};
  Parameters values;
  values.set("k", model.k).set("A", model.A).set("beta", model.beta).set("gamma", model.gamma);
  values.set("n", model.n).set("z_0", model.z_0).set("offset", model.offset);
  out.stage.model = checked_model("bouc_wen", values);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace

ModelType bouc_wen_type() {
  return {"bouc_wen",
          "differential equation with a hysteretic state",
          "Bouc 1967, Wen 1976; Low and Guo 1995",
          infos(),
          check,
          make,
          make_inverse_of,
          identify};
}

}  // namespace bodesmith::hysteresis
