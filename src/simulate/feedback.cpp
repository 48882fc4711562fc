#include "simulate/feedback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "simulate/dense_signal.hpp"
#include "simulate/feedback_exact.hpp"
#include "simulate/ode_run.hpp"
#include "simulate/record_metrics.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::SampledKernel;

LoopResult run_in_cvode(const chain::Chain& plant, const TimeRecord& forward, const PidController& controller,
                        const TimeRecord& reference, const Options& options) {
  LoopResult out;
  std::vector<Kernel> kernels;
  for (std::size_t i = 0; i < plant.blocks.size(); ++i) {
    kernels.push_back(plant.blocks[i].kernel());
    const auto* linear = std::get_if<LinearKernel>(&kernels.back());
    const auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernels.back());
    if (linear != nullptr) out.model_error += linear->approximation_error;
    const bool fits = linear != nullptr ? linear->delay_s == 0.0
                      : memory != nullptr
                          ? (*memory)->rate_independent() || (*memory)->slew_rate() > 0.0
                          : !std::holds_alternative<std::unique_ptr<SampledKernel>>(kernels.back());
    if (!fits) {
      throw DesignError(fmt::format(
          "block {} ({}) of the plant cannot stand inside a feedback loop, expected dynamics, curves or "
          "rate-independent memory",
          i + 1, plant.blocks[i].type_name()));
    }
  }
  std::vector<Kernel*> pointers;
  for (Kernel& kernel : kernels) pointers.push_back(&kernel);
  // A part at the front passes the drive on unchanged, so that it is seen even without blocks.
  Kernel front = LinearKernel{};
  std::get<LinearKernel>(front).d = 1.0;
  pointers.insert(pointers.begin(), &front);

  const DenseSignal input = DenseSignal::from_record(forward);
  DenseSignal wanted_signal = DenseSignal::from_record(reference);
  OdeRun ode(pointers, input);
  double rest = forward.u.front();
  ode.start(options.start, rest);
  if (!ode.close_loop(controller, wanted_signal)) {
    throw DesignError(
        "the plant answers its drive at once, expected a strictly proper block in it (an amplifier's "
        "lowpass, a resonator) with "
        "no memory behind it");
  }
  OdeRun::Wanted wanted;
  wanted.right_limits = controller.period_s > 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) wanted.times.push_back(reference.time_s(i));
  wanted.values = &out.y;
  wanted.drive = &out.drive;
  out.stats.engine = "cvode";
  ode.solve(options, wanted, out.stats, reference.step_s);
  return out;
}

/// Nothing, and the reason, when there is no closed form.
std::optional<LoopResult> run_exact(const chain::Chain& plant, const std::vector<double>& feedforward,
                                    const PidController& controller, const TimeRecord& reference,
                                    const Options& options, std::string& why_not) {
  const Stopwatch watch;
  auto out = run_exact_loop(plant, feedforward, controller, reference, options.start, 1, why_not);
  if (!out) return out;
  out->stats.compute_s = watch.seconds();
  if (options.estimate_error) {
    const auto again = run_exact_loop(plant, feedforward, controller, reference, options.start, 2, why_not);
    out->error_estimate = compare_records(out->y, again->y).max;
  }
  return out;
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
      Options finer = options;
      finer.relative_tolerance *= 0.1;
      finer.absolute_tolerance *= 0.1;
      const LoopResult again = run_in_cvode(plant, forward, controller, reference, finer);
      out.error_estimate = compare_records(out.y, again.y).max;
    }
    return out;
  } catch (const InputError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(
        fmt::format("the loop cannot be solved: {} (an unstable loop? or a block that jumps when its input "
                    "turns, which only a sampled controller can drive)",
                    error.what()));
  }
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
  if (reference.size() < 2) throw InputError("the reference has fewer than two samples");
  if (feedforward.size() != reference.size()) {
    throw InputError(fmt::format("the feed-forward signal has {} samples, expected the reference's {}",
                                 feedforward.size(), reference.size()));
  }
  if (!(controller.derivative_corner.value > 0.0) || controller.period_s < 0.0 ||
      !(controller.lower < controller.upper)) {
    throw InputError("the controller's derivative corner, period or limits are out of range");
  }
  if (options.engine == Engine::record) {
    throw InputError("a loop cannot be worked out block by block, expected the engine exact or cvode");
  }
  std::string why_not;
  std::optional<LoopResult> out;
  if (options.engine != Engine::cvode)
    out = run_exact(plant, feedforward, controller, reference, options, why_not);
  if (!out && options.engine == Engine::exact) throw InputError("the loop has no closed form: " + why_not);
  if (!out) out = run_cvode(plant, feedforward, controller, reference, options);
  for (const double y : out->y) {
    if (!std::isfinite(y) || std::abs(y) > 1e100)
      throw InputError("the loop is unstable: its output grows without bound");
  }
  return std::move(*out);
}

}  // namespace bodesmith::simulate
