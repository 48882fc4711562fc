#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hysteresis/everett_trace.hpp"
#include "hysteresis/identification/preisach_identify.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/krasnoselskii_pokrovskii.hpp"
#include "hysteresis/model_type.hpp"
#include "numeric/index.hpp"
#include "numeric/optimisation/least_squares.hpp"
#include "numeric/optimisation/population_search.hpp"

namespace bodesmith::hysteresis {
namespace {

/// The parameters as the fit holds them.
struct KpFit {
  Range u;
  std::vector<double> mu;
  double offset = 0.0;
  double a1 = 1.0;
  double a2 = 0.0;

  Parameters parameters() const {
    return Parameters()
        .set("u_min", u.low)
        .set("u_max", u.high)
        .set("mu", mu)
        .set("offset", offset)
        .set("a1", a1)
        .set("a2", a2);
  }
};

/// Mean |u̇| of a record.
double speed(const TimeRecord& record) {
  double way = 0.0;
  for (std::size_t i = 1; i < record.size(); ++i) way += std::abs(record.u[i] - record.u[i - 1]);
  return way / std::max(record.duration_s(), 1e-300);
}

/// The densities as the paper finds them: particle swarm with cuckoo search over every one of them.
void fit_densities_by_swarm(std::span<const TimeRecord> records, const IdentifyOptions& options, KpFit& fit,
                            Identified& out) {
  const auto levels = static_cast<std::size_t>(options.size > 0 ? options.size : 10);
  EverettTrace trace(fit.u.low, fit.u.high, levels, CellShape::kp);
  for (const TimeRecord& record : records) trace.add(record, first_counted(record, options.skip_s));
  const Eigen::VectorXd y = counted_outputs(records, options.skip_s);
  const double mean = y.mean();
  Eigen::VectorXd got;
  const auto cost = [&](const Eigen::VectorXd& x) {
    trace.apply(x, got);
    const double shift = mean - got.mean();
    return (got.array() + shift - y.array()).square().sum();
  };
  PsoCuckooOptions search{.generations = static_cast<int>(300 * options.effort), .seed = options.seed};
  const Eigen::VectorXd lower = Eigen::VectorXd::Zero(trace.columns());
  const double each = 6.0 * (y.maxCoeff() - y.minCoeff()) / static_cast<double>(trace.columns());
  const PsoCuckooResult found =
      pso_cuckoo(cost, lower, Eigen::VectorXd::Constant(trace.columns(), each), search);
  fit.mu = to_vector(found.x);
  cost(found.x);
  fit.offset = mean - got.mean();
  out.method = fmt::format("particle swarm with cuckoo search over {} densities, {} evaluations",
                           fit.mu.size(), found.evaluations);
  out.notes.push_back(
      "the problem is convex: the method 'best' solves it exactly and finds densities for finer grids too");
}

/// The densities by convex least squares.
void fit_densities(std::span<const TimeRecord> records, const IdentifyOptions& options, KpFit& fit,
                   Identified& out) {
  const auto levels = static_cast<std::size_t>(options.size > 0 ? options.size : 100);
  const PreisachWeights solved = fit_preisach_weights(records, options.skip_s, fit.u.low, fit.u.high, levels,
                                                      CellShape::kp, static_cast<int>(3000 * options.effort));
  fit.mu = solved.weights;
  fit.offset = solved.offset;
  out.converged = solved.converged;
  out.method = fmt::format(
      "non-negative least squares of {} densities on the stack of extremes (convex), {} iterations",
      fit.mu.size(), solved.iterations);
  out.notes.push_back(fmt::format("{} of {} densities are above 0; {} kernels never move in the record",
                                  solved.active, fit.mu.size(), solved.unseen));
}

/// a1 and a2 for given densities, from records of several rates.
void fit_rate_function(std::span<const TimeRecord> records, double skip_s, double fastest, KpFit& fit,
                       Identified& out) {
  Eigen::VectorXd lower(2), upper(2), typical(2), start(2);
  // a2 in units of 1/speed: at 0.3 the factor is e^(∓0.3) in the fastest record.
  lower << 0.05, 0.0;
  upper << 5.0, 0.5;
  typical << 1.0, 0.01;
  start << 1.0, 0.005;
  const LeastSquaresResult solved = fit_parameters(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
        KpFit at = fit;
        at.a1 = x(0);
        at.a2 = x(1) / fastest;
        operator_residual(KpOperator(KrasnoselskiiPokrovskii::from(at.parameters())), records, skip_s, r);
      },
      start, lower, upper, typical, 40);
  fit.a1 = solved.values(0);
  fit.a2 = solved.values(1) / fastest;
  out.uncertainty = {{"a1", fit.a1, solved.deviation(0)}, {"a2", fit.a2, solved.deviation(1) / fastest}};
  out.notes.push_back("densities from the slowest record, a1 and a2 from all");
  if (fit.a2 == 0.0)
    out.notes.push_back("a2 is at its bound 0: the records' loops do not widen the way eq. 3 can follow");
}

}  // namespace

Identified identify_krasnoselskii_pokrovskii(std::span<const TimeRecord> records,
                                             const IdentifyOptions& options) {
  KpFit fit;
  fit.u = swept_range(records);
  // The densities come from the slowest record (KP paper, section 4.1), the rate function from all.
  const TimeRecord* slowest = &records[0];
  double fastest = 0.0;
  for (const TimeRecord& record : records) {
    if (speed(record) < speed(*slowest)) slowest = &record;
    fastest = std::max(fastest, speed(record));
  }
  const bool many_rates = fastest > 1.5 * speed(*slowest);
  const std::span<const TimeRecord> base = many_rates ? std::span<const TimeRecord>(slowest, 1) : records;
  Identified out;
  if (options.as_in_paper()) {
    fit_densities_by_swarm(base, options, fit, out);
  } else {
    fit_densities(base, options, fit, out);
  }
  if (many_rates) {
    fit_rate_function(records, options.skip_s, fastest, fit, out);
  } else {
    out.notes.push_back("the records have one rate only: a1 = 1, a2 = 0 (classic KP)");
  }
  out.model = make_model("krasnoselskii_pokrovskii", fit.parameters());
  return out;
}

}  // namespace bodesmith::hysteresis
