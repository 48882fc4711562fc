#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>

#include "hysteresis/fractional_dynamic.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "lti/fractional_transfer.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/least_squares.hpp"
#include "numeric/optimisation/population_search.hpp"

namespace bodesmith::hysteresis {
namespace {

constexpr int kModes = 60;        ///< sections of the result
constexpr int kSearchModes = 28;  ///< enough to find the valley

/// Shape parameters: ln(tau/T), ln(omega_n T), xi, eta, lambda, ln chi·…, ln(Theta/K_p …), T the sampling
/// time; the gain, slope and constant are linear and solved for inside.
FractionalDynamic dynamics_of(const Eigen::VectorXd& x, double step_s, int modes) {
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

/// With the gain, slope and constant that fit best.
struct ProjectedDynamics {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< gain, slope, constant
  Eigen::VectorXd residual;
};

ProjectedDynamics project(const FractionalDynamic& model, std::span<const TimeRecord> records,
                          double skip_s) {
  const Eigen::VectorXd y = counted_outputs(records, skip_s);
  Eigen::MatrixXd a(y.size(), 3);
  Eigen::Index at = 0;
  FractionalOperator op(model);
  drive(op, records, skip_s, [&](double value, const TimeRecord& record, std::size_t i) {
    a.row(at++) << value, record.step_s * static_cast<double>(i), 1.0;
  });
  ProjectedDynamics out;
  const Eigen::Vector3d scale = a.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = a * scale.asDiagonal();
  Eigen::MatrixXd gram = bodesmith::gram(scaled);
  gram.diagonal().array() += 1e-13;
  out.linear = scale.cwiseProduct(solve_ldlt(gram, transpose_times(scaled, y)));
  out.residual = a * out.linear - y;
  return out;
}

/// Where the search may go, and the size of a step in each direction.
struct DynamicsBounds {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  Eigen::VectorXd typical;
};

DynamicsBounds bounds_of(std::span<const TimeRecord> records) {
  const double step_s = records[0].step_s;
  double longest = 0.0;
  for (const TimeRecord& record : records) longest = std::max(longest, record.duration_s());
  DynamicsBounds out{Eigen::VectorXd(7), Eigen::VectorXd(7), Eigen::VectorXd(7)};
  const double slow = std::log(longest / step_s);
  // χ and Θ between where they act above the band and below it.
  const double fast = std::log(step_s);
  out.lower << std::log(0.05), std::log(0.02), 0.005, 0.05, 0.05, 0.9 * fast, 0.9 * fast;
  out.upper << slow - 2.0, std::log(3.0), 1.5, 0.98, 0.98, fast + slow + 6.0, fast + slow + 6.0;
  out.typical << 1.0, 1.0, 0.1, 0.1, 0.1, 1.0, 1.0;
  return out;
}

/// 4000 samples at most, in a row: enough for the search's aim, the valley.
std::vector<TimeRecord> shortened(std::span<const TimeRecord> records, double skip_s) {
  std::vector<TimeRecord> out(records.begin(), records.end());
  const std::size_t max_samples = std::max<std::size_t>(4000 / records.size(), 400);
  for (TimeRecord& record : out) {
    const std::size_t keep = std::min(record.size(), first_counted(record, skip_s) + max_samples);
    record.u.resize(keep);
    record.y.resize(keep);
  }
  return out;
}

void describe(const FractionalDynamic& model, const Eigen::VectorXd& deviation, Identified& out) {
  out.uncertainty = {{"tau", model.tau, model.tau * deviation(0)},
                     {"omega_n", model.omega_n, model.omega_n * deviation(1)},
                     {"xi", model.xi, deviation(2)},
                     {"eta", model.eta, deviation(3)},
                     {"lambda", model.lambda, deviation(4)},
                     {"chi", model.chi, model.chi * deviation(5)},
                     {"Theta", model.theta, model.theta * deviation(6)}};
  out.notes.push_back("K_p is set to 1: only K_M K_p and K_M Theta are determined");
  const int roots = fractional_stability(model.denominator()).unstable_poles;
  out.notes.push_back(roots == 0 ? "stable: no root to the right by the argument principle"
                                 : fmt::format("NOT stable: {} roots to the right", roots));
  out.notes.push_back("the model is linear: it holds for the amplitudes of the record");
}

Model model_of(const FractionalDynamic& model) {
  return make_model("fractional_dynamic", Parameters()
                                              .set("K_M", model.k_m)
                                              .set("xi", model.xi)
                                              .set("omega_n", model.omega_n)
                                              .set("tau", model.tau)
                                              .set("eta", model.eta)
                                              .set("lambda", model.lambda)
                                              .set("K_p", model.k_p)
                                              .set("Theta", model.theta)
                                              .set("chi", model.chi)
                                              .set("rho", model.rho)
                                              .set("delta", model.delta)
                                              .set("modes", model.modes));
}

}  // namespace

Identified identify_fractional_dynamic(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  swept_range(records);
  const double step_s = records[0].step_s;
  const DynamicsBounds bounds = bounds_of(records);
  const std::vector<TimeRecord> brief = shortened(records, options.skip_s);
  DifferentialEvolutionOptions search;
  search.seed = options.seed;
  search.population = 36;
  search.generations = std::max(3, static_cast<int>(90 * options.effort));
  const DifferentialEvolutionResult found = differential_evolution(
      [&](const Eigen::VectorXd& x) {
        return project(dynamics_of(x, step_s, kSearchModes), brief, options.skip_s).residual.squaredNorm();
      },
      bounds.lower, bounds.upper, search);
  // The paper's method only needs the deviations at its own solution.
  const bool paper = options.as_in_paper();
  const LeastSquaresResult refined = fit_parameters(
      [&](const Eigen::VectorXd& at, Eigen::VectorXd& r) {
        r = project(dynamics_of(at, step_s, kModes), records, options.skip_s).residual;
      },
      found.x, bounds.lower, bounds.upper, bounds.typical, paper ? 1 : 25);
  FractionalDynamic model = dynamics_of(paper ? found.x : refined.values, step_s, kModes);
  const ProjectedDynamics projected = project(model, records, options.skip_s);
  model.k_m *= projected.linear(0);
  model.rho = projected.linear(1);
  model.delta = projected.linear(2);
  Identified out;
  out.method = fmt::format("self-adaptive differential evolution, {} evaluations{}", found.evaluations,
                           paper ? "" : ", then nonlinear least squares");
  out.converged = paper || converged(refined.termination);
  describe(model, refined.deviation, out);
  out.model = model_of(model);
  return out;
}

}  // namespace bodesmith::hysteresis
