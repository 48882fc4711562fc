#include "simulate/feedback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "simulate/dense_signal.hpp"
#include "simulate/ode_run.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::SampledKernel;

LoopResult run(const chain::Chain& plant, const TimeRecord& forward, const PidController& controller,
               const TimeRecord& reference, const Options& options) {
  std::vector<Kernel> kernels;
  for (std::size_t i = 0; i < plant.blocks.size(); ++i) {
    kernels.push_back(plant.blocks[i].kernel());
    const auto* linear = std::get_if<LinearKernel>(&kernels.back());
    const auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernels.back());
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
  LoopResult out;
  OdeRun::Wanted wanted;
  for (std::size_t i = 0; i < reference.size(); ++i) wanted.times.push_back(reference.time_s(i));
  wanted.values = &out.y;
  wanted.drive = &out.drive;
  out.stats.engine = "cvode";
  ode.solve(options, wanted, out.stats, reference.step_s);
  return out;
}

}  // namespace

LoopResult simulate_loop(const chain::Chain& plant, const std::optional<chain::Chain>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options) {
  if (reference.size() < 2) throw InputError("the reference has fewer than two samples");
  if (!(controller.derivative_corner.value > 0.0) || controller.period_s < 0.0 ||
      !(controller.lower < controller.upper)) {
    throw InputError("the controller's derivative corner, period or limits are out of range");
  }
  const Stopwatch watch;
  TimeRecord forward = reference;
  forward.y.clear();
  if (feedforward) {
    Options once = options;
    once.engine = Engine::automatic;
    forward.u = simulate(*feedforward, reference, once).y;
  } else {
    std::fill(forward.u.begin(), forward.u.end(), 0.0);
  }
  LoopResult out;
  try {
    out = run(plant, forward, controller, reference, options);
    out.stats.compute_s = watch.seconds();
    if (options.estimate_error) {
      Options finer = options;
      finer.relative_tolerance *= 0.1;
      finer.absolute_tolerance *= 0.1;
      const LoopResult again = run(plant, forward, controller, reference, finer);
      double most = 0.0;
      for (std::size_t i = 0; i < out.y.size(); ++i) most = std::max(most, std::abs(out.y[i] - again.y[i]));
      out.error_estimate = most;
    }
  } catch (const InputError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(fmt::format("the loop cannot be solved: {} (is it unstable?)", error.what()));
  }
  for (const double y : out.y) {
    if (!std::isfinite(y) || std::abs(y) > 1e100)
      throw InputError("the loop is unstable: its output grows without bound");
  }
  return out;
}

}  // namespace bodesmith::simulate
