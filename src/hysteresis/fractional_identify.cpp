#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/fractional_dynamic.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/differential_evolution.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

const std::vector<ParameterInfo>& infos() {
  static const std::vector<ParameterInfo> list = {
      scalar("K_M", "1", "gain in front of the resonance"),
      scalar("xi", "1", "damping ratio of the resonance", 1e-6, 100.0),
      scalar("omega_n", "rad/s", "natural frequency of the resonance", 1e-300),
      scalar("tau", "s", "time constant of amplifier and capacitance", 1e-300),
      scalar("eta", "1", "order of the voltage's derivative", 1e-3, 0.999),
      scalar("lambda", "1", "order of the force's derivative", 1e-3, 0.999),
      scalar("K_p", "1", "constant gain of the hysteresis force", 1e-300),
      scalar("Theta", "s^eta", "gain of the voltage's derivative", 0.0),
      scalar("chi", "s^lambda", "gain of the force's derivative", 0.0),
      optional(scalar("rho", "y/s", "slope of the linear compensator"), {0.0}),
      optional(scalar("delta", "y", "constant of the linear compensator"), {0.0}),
      optional(scalar("modes", "1", "first-order sections of the simulation", 8, 400), {60}),
  };
  return list;
}

void check(const Parameters& values) {
  (void)FractionalDynamic::from(values);
}

std::unique_ptr<Operator> make(const Parameters& values) {
  return std::make_unique<FractionalOperator>(FractionalDynamic::from(values));
}

/// F⁻¹ over the static gain, and the whole model beside it to say what comes out.
class FractionalInverse final : public Inverse {
 public:
  explicit FractionalInverse(const FractionalDynamic& model)
      : model_(model), forward_(model), back_(inverse_of(model)) {}
  std::unique_ptr<Inverse> clone() const override { return std::make_unique<FractionalInverse>(*this); }
  double reset(double y) override {
    time_ = 0.0;
    const double u = back_.reset(y - model_.delta);
    achieved_ = forward_.reset(u);
    return u;
  }
  double step(double y, double dt_s) override {
    time_ += dt_s;
    const double u = back_.step(y - model_.delta - model_.rho * time_, dt_s);
    achieved_ = forward_.step(u, dt_s);
    return u;
  }
  double achieved() const override { return achieved_; }

 private:
  /// Numerator and denominator of F exchanged, with a lag and a resonance far above everything.
  static FractionalDynamic inverse_of(const FractionalDynamic& m) {
    FractionalDynamic out;
    out.k_p = 1.0;
    out.eta = m.lambda;
    out.theta = m.chi;
    out.lambda = m.eta;
    out.chi = m.theta / m.k_p;
    out.omega_n = 100.0 * std::max(m.omega_n, 1.0 / m.tau);
    out.xi = 0.7;
    out.tau = 0.01 * std::min(m.tau, 1.0 / m.omega_n);
    out.k_m = out.omega_n * out.omega_n / m.static_gain();
    out.modes = std::max(m.modes, 60);
    return out;
  }
  FractionalDynamic model_;
  FractionalOperator forward_;
  FractionalOperator back_;
  double time_ = 0.0;
  double achieved_ = 0.0;
};

std::unique_ptr<Inverse> make_inverse_of(const Parameters& values) {
  const FractionalDynamic model = FractionalDynamic::from(values);
  if (model.static_gain() == 0.0) throw DesignError("K_M is 0: there is no inverse");
  return std::make_unique<FractionalInverse>(model);
}

/// Shape parameters: ln(tau/T), ln(omega_n T), xi, eta, lambda, ln chi·…, ln(Theta/K_p …), T the sampling
/// time; the gain, slope and constant are linear and solved for inside.
FractionalDynamic shape(const Eigen::VectorXd& x, double step_s, int modes) {
  FractionalDynamic out;
  out.tau = step_s * std::exp(x(0));
  out.omega_n = std::exp(x(1)) / step_s;
  out.xi = x(2);
  out.eta = x(3);
  out.lambda = x(4);
  out.chi = std::exp(x(5));
  out.theta = std::exp(x(6));
  out.k_p = 1.0;
  out.k_m = out.omega_n * out.omega_n;  // static gain 1
  out.modes = modes;
  return out;
}

struct Projected {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< gain, slope, constant
  Eigen::VectorXd residual;
};

Projected project(const FractionalDynamic& model, std::span<const TimeRecord> records, double skip_s) {
  const auto rows = static_cast<Eigen::Index>(counted_samples(records, skip_s));
  Eigen::MatrixXd a(rows, 3);
  Eigen::VectorXd y(rows);
  Eigen::Index at = 0;
  FractionalOperator op(model);
  for (const TimeRecord& record : records) {
    const std::size_t first = first_counted(record, skip_s);
    double value = op.reset(record.u[0]);
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (i > 0) value = op.step(record.u[i], record.step_s);
      if (i < first) continue;
      a.row(at) << value, record.step_s * static_cast<double>(i), 1.0;
      y(at++) = record.y[i];
    }
  }
  Projected out;
  const Eigen::Vector3d scale = a.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = a * scale.asDiagonal();
  Eigen::Matrix3d gram = scaled.transpose() * scaled;
  gram.diagonal().array() += 1e-13;
  out.linear = scale.asDiagonal() * gram.ldlt().solve(scaled.transpose() * y);
  out.residual = a * out.linear - y;
  return out;
}

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  const Range u = input_range(records, 0.0);
  if (!(u.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  const double step_s = records[0].step_s;
  double longest = 0.0;
  for (const TimeRecord& record : records) longest = std::max(longest, record.duration_s());
  Eigen::VectorXd lower(7), upper(7), typical(7);
  const double slow = std::log(longest / step_s);
  // χ and Θ between where they act above the band and below it.
  const double fast = std::log(step_s);
  lower << std::log(0.05), std::log(0.02), 0.005, 0.05, 0.05, 0.9 * fast, 0.9 * fast;
  upper << slow - 2.0, std::log(3.0), 1.5, 0.98, 0.98, std::log(std::max(longest, 1.0)) + 6.0,
      std::log(std::max(longest, 1.0)) + 6.0;
  typical << 1.0, 1.0, 0.1, 0.1, 0.1, 1.0, 1.0;
  // The search looks at 4000 samples at most, in a row: enough for its aim, the valley.
  std::vector<TimeRecord> brief(records.begin(), records.end());
  const std::size_t most = std::max<std::size_t>(4000 / records.size(), 400);
  for (TimeRecord& record : brief) {
    const std::size_t keep = std::min(record.size(), first_counted(record, options.skip_s) + most);
    record.u.resize(keep);
    record.y.resize(keep);
  }
  DifferentialEvolutionOptions search;
  search.seed = options.seed;
  search.population = 36;
  search.generations = std::max(3, static_cast<int>(90 * options.effort));
  const DifferentialEvolutionResult found = differential_evolution(
      [&](const Eigen::VectorXd& x) {
        return project(shape(x, step_s, 28), brief, options.skip_s).residual.squaredNorm();
      },
      lower, upper, search);
  Eigen::VectorXd x = found.x;
  Identified out;
  const auto residual = [&](const Eigen::VectorXd& at, Eigen::VectorXd& r) {
    r = project(shape(at, step_s, 60), records, options.skip_s).residual;
  };
  const bool paper = options.method == "paper";
  const LeastSquaresResult refined = least_squares(residual, x, lower, upper, typical, paper ? 1 : 25);
  if (!paper) x = refined.x;
  FractionalDynamic model = shape(x, step_s, 60);
  const Projected linear = project(model, records, options.skip_s);
  model.k_m *= linear.linear(0);
  model.rho = linear.linear(1);
  model.delta = linear.linear(2);
  out.method = fmt::format("self-adaptive differential evolution, {} evaluations{}", found.evaluations,
                           paper ? "" : ", then nonlinear least squares");
  out.converged = paper || refined.converged;
  out.uncertainty = {{"tau", model.tau, model.tau * refined.deviation(0)},
                     {"omega_n", model.omega_n, model.omega_n * refined.deviation(1)},
                     {"xi", model.xi, refined.deviation(2)},
                     {"eta", model.eta, refined.deviation(3)},
                     {"lambda", model.lambda, refined.deviation(4)},
                     {"chi", model.chi, model.chi * refined.deviation(5)},
                     {"Theta", model.theta, model.theta * refined.deviation(6)}};
  out.notes.push_back("K_p is set to 1: only K_M K_p and K_M Theta are determined");
  const int roots = right_half_plane_roots(FractionalPolynomial::denominator(model));
  out.notes.push_back(roots == 0 ? "stable: no root to the right by the argument principle"
                                 : fmt::format("NOT stable: {} roots to the right", roots));
  out.notes.push_back("the model is linear: it holds for the amplitudes of the record");
  Parameters values;
  values.set("K_M", model.k_m).set("xi", model.xi).set("omega_n", model.omega_n).set("tau", model.tau);
  values.set("eta", model.eta).set("lambda", model.lambda).set("K_p", model.k_p).set("Theta", model.theta);
  values.set("chi", model.chi).set("rho", model.rho).set("delta", model.delta).set("modes", 60.0);
  out.stage.model = checked_model("fractional_dynamic", values);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace

FractionalDynamic FractionalDynamic::from(const Parameters& values) {
  FractionalDynamic out;
  out.k_m = values.scalar("K_M");
  out.xi = values.scalar("xi");
  out.omega_n = values.scalar("omega_n");
  out.tau = values.scalar("tau");
  out.eta = values.scalar("eta");
  out.lambda = values.scalar("lambda");
  out.k_p = values.scalar("K_p");
  out.theta = values.scalar("Theta");
  out.chi = values.scalar("chi");
  out.rho = values.scalar("rho");
  out.delta = values.scalar("delta");
  out.modes = static_cast<int>(values.scalar("modes"));
  return out;
}

ModelType fractional_dynamic_type() {
  return {"fractional_dynamic",
          "linear fractional hysteresis force with lag and resonance",
          "003, eq. 8-19",
          infos(),
          check,
          make,
          make_inverse_of,
          identify};
}

}  // namespace bodesmith::hysteresis
