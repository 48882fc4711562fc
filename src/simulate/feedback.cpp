#include "simulate/feedback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/linear_kernel.hpp"
#include "signal/error_figures.hpp"
#include "simulate/cvode_solver.hpp"
#include "simulate/dense_signal.hpp"
#include "simulate/feedback_exact.hpp"
#include "simulate/ode_solve.hpp"
#include "simulate/simulate.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Kernel;
using chain::LinearKernel;

/// The plant's kernels, each of which can stand in an ODE. DesignError names one that cannot.
std::vector<Kernel> plant_kernels(const chain::Chain& plant) {
  std::vector<Kernel> out;
  for (std::size_t i = 0; i < plant.blocks.size(); ++i) {
    out.push_back(plant.blocks[i].kernel());
    if (!can_stand_in_ode(out.back())) {
      throw DesignError(fmt::format(
          "block {} ({}) of the plant cannot stand inside a feedback loop, expected dynamics, curves or "
          "rate-independent memory",
          i + 1, plant.blocks[i].type_name()));
    }
  }
  return out;
}

LoopResult run_in_cvode(const chain::Chain& plant, const TimeRecord& forward, const PidController& controller,
                        const TimeRecord& reference, const Options& options) {
  LoopResult out;
  out.stats.engine = Engine::cvode;
  constexpr double kMostRestarts = 5e6;  // CVODE starts again at every one
  if (controller.period_s > 0.0)
    require_few_edges(reference.duration_s() / controller.period_s, "the controller's clock", kMostRestarts);
  std::vector<Kernel> kernels = plant_kernels(plant);
  // A part at the front passes the drive on unchanged, so that it is seen even without blocks.
  Kernel front = chain::gain_kernel(1.0);
  std::vector<Kernel*> pointers = {&front};
  for (Kernel& kernel : kernels) {
    if (const auto* linear = std::get_if<LinearKernel>(&kernel))
      out.model_error += linear->approximation_error;
    pointers.push_back(&kernel);
  }
  const DenseSignal input = DenseSignal::from_record(forward);
  const DenseSignal dense_reference = DenseSignal::from_record(reference);
  OdeSystem system(pointers, input);
  system.start(start_of(plant, options.start), forward.u.front());
  if (system.close_loop(controller, dense_reference) == OdeSystem::LoopOutcome::algebraic) {
    throw DesignError(
        "the plant answers its drive at once, expected a strictly proper block in it (an amplifier's "
        "lowpass, a resonator) with no memory after it");
  }
  OdeRequest request;
  request.right_limits = controller.period_s > 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) request.times.push_back(reference.time_s(i));
  request.values = &out.y;
  request.drive = &out.drive;
  solve_ode(system, options, request, out.stats, reference.step_s);
  return out;
}

LoopOutcome run_exact(const chain::Chain& plant, const std::vector<double>& feedforward,
                      const PidController& controller, const TimeRecord& reference, const Options& options) {
  const Stopwatch watch;
  LoopOutcome outcome =
      run_exact_loop(plant, feedforward, controller, reference, start_of(plant, options.start), 1);
  auto* out = std::get_if<LoopResult>(&outcome);
  if (out == nullptr) return outcome;
  out->stats.compute_s = watch.seconds();
  if (options.estimate_error) {
    const LoopOutcome again =
        run_exact_loop(plant, feedforward, controller, reference, start_of(plant, options.start), 2);
    out->error_estimate = error_figures(out->y, std::get<LoopResult>(again).y).max;
  }
  return outcome;
}

LoopResult run_cvode(const chain::Chain& plant, const std::vector<double>& feedforward,
                     const PidController& controller, const TimeRecord& reference, const Options& options) {
  const Stopwatch watch;
  TimeRecord forward = reference;
  forward.y.clear();
  forward.u = feedforward;
  try {
    LoopResult out = run_in_cvode(plant, forward, controller, reference, options);
    out.stats.compute_s = watch.seconds();
    if (options.estimate_error) {
      const LoopResult again = run_in_cvode(plant, forward, controller, reference, options.finer());
      out.error_estimate = error_figures(out.y, again.y).max;
    }
    return out;
  } catch (const SolverFailure& failure) {
    throw InputError(
        fmt::format("the loop cannot be solved: {} (an unstable loop? or a block that jumps when its input "
                    "turns, which only a sampled controller can drive)",
                    failure.what()));
  }
}

void validate_loop(const std::vector<double>& feedforward, const PidController& controller,
                   const TimeRecord& reference, const Options& options) {
  if (reference.size() < 2) throw InputError("the reference has fewer than two samples");
  if (feedforward.size() != reference.size()) {
    throw InputError(fmt::format("the feed-forward signal has {} samples, expected the reference's {}",
                                 feedforward.size(), reference.size()));
  }
  if (!(controller.derivative_corner.value > 0.0) || controller.period_s < 0.0 ||
      !(controller.lower < controller.upper)) {
    throw InputError("the controller's derivative corner, period or limits are out of range");
  }
  if (controller.period_s > 0.0)
    require_few_edges(reference.duration_s() / controller.period_s,
                      fmt::format("a controller that samples every {} s", rounded_text(controller.period_s)));
  if (options.engine == Engine::record) {
    throw InputError("a loop cannot be worked out block by block, expected the engine exact or cvode");
  }
}

/// In closed form where there is one and it is not forbidden, else in CVODE where that is allowed.
LoopResult run_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                    const PidController& controller, const TimeRecord& reference, const Options& options) {
  if (options.engine == Engine::cvode) return run_cvode(plant, feedforward, controller, reference, options);
  LoopOutcome exact = run_exact(plant, feedforward, controller, reference, options);
  if (auto* out = std::get_if<LoopResult>(&exact)) return std::move(*out);
  if (options.engine == Engine::exact)
    throw InputError("the loop has no closed form: " + std::get<NoClosedForm>(exact).text);
  return run_cvode(plant, feedforward, controller, reference, options);
}

}  // namespace

LoopResult simulate_loop(const chain::Chain& plant, const std::optional<chain::Chain>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options) {
  if (!feedforward) {
    return simulate_loop(plant, std::vector<double>(reference.size(), 0.0), controller, reference, options);
  }
  Options once = options;
  once.engine = Engine::automatic;
  return simulate_loop(plant, simulate(*feedforward, reference, once).y, controller, reference, options);
}

LoopResult simulate_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options) {
  validate_loop(feedforward, controller, reference, options);
  LoopResult out = run_loop(plant, feedforward, controller, reference, options);
  for (const double y : out.y) {
    if (!std::isfinite(y) || std::abs(y) > 1e100)
      throw InputError("the loop is unstable: its output grows without bound");
  }
  return out;
}

}  // namespace bodesmith::simulate
