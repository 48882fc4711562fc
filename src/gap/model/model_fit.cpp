#include "gap/model/model_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gap/runner.hpp"
#include "signal/statistics.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

/// Fits with another unit of the residual at the most.
constexpr int kMaxUnits = 4;
/// A unit is kept when what is left is more than this part of it.
constexpr double kSameUnit = 0.5;

/// Size of an initial state that free responses are found with, as a part of the output: small, so that
/// nonlinear dynamics answer in proportion.
constexpr double kNudge = 1e-5;
/// A free response that others explain but for this part of it is no direction of its own.
constexpr double kMinOwnPart = 1e-3;

double off_from_given(const Unknown& u, double value) {
  return u.logarithmic ? std::log(value / u.given) : value - u.given;
}

}  // namespace

FittedModel fit(Model model, const Experiments& experiments, LeastSquaresOptions options) {
  Runners runner(model, experiments);
  options.threads = runner.threads();
  const auto unknowns = model.unknowns();
  const auto known = static_cast<std::size_t>(
      std::count_if(unknowns.begin(), unknowns.end(), [](const Unknown& u) { return u.given_spread > 0.0; }));
  double unit = 0.0;
  std::vector<double> first;
  if (runner(current_values(model), first)) unit = rms(first);
  const auto residuals = [&](std::span<const double> v, std::vector<double>& out) {
    if (!runner(v, out)) return false;
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      const auto& u = unknowns[k];
      if (u.given_spread > 0.0) out.push_back(unit * off_from_given(u, v[k]) / u.given_spread);
    }
    return true;
  };
  LeastSquaresResult result;
  for (int round = 0; round < kMaxUnits; ++round) {
    result = least_squares(model.unknowns(), residuals, options);
    if (!result.usable()) break;
    model.set_values(result.values);
    result.residuals.resize(result.residuals.size() - known);
    const double left = rms(result.residuals);
    if (known == 0 || left > kSameUnit * unit || (options.stop && options.stop())) break;
    unit = left;
  }
  result.rms = rms(result.residuals);
  return {std::move(model), std::move(result)};
}

Directions free_responses(const Model& model, const TimeExperiment& experiment, std::size_t first) {
  const auto& record = experiment.record();
  const auto input = std::span<const double>(record.u).first(experiment.end());
  simulate::RecordOptions options;
  options.start_s = record.start_s;
  simulate::RecordSimulator simulator(model.chain(), record.step_s, options);
  const auto from_rest = simulator.run(input).subspan(first);
  const std::vector<double> base(from_rest.begin(), from_rest.end());
  const double nudge = kNudge * std::max(rms(base), 1e-300);
  Directions directions;
  for (double& state : simulator.initial_states()) {
    state = nudge;
    const auto y = simulator.run(input).subspan(first);
    state = 0.0;
    std::vector<double> response(base.size());
    for (std::size_t i = 0; i < response.size(); ++i) response[i] = (y[i] - base[i]) / nudge;
    directions.add(std::move(response), kMinOwnPart);
  }
  return directions;
}

}  // namespace bodesmith::gap
