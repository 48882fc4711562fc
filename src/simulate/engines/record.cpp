// The record engine: record_simulator.hpp behind the common door.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "signal/statistics.hpp"
#include "simulate/engines/engine.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::simulate {
namespace {

struct RecordMethod {
  std::string_view operator()(const chain::LinearKernel&) const { return "matrix exponential on each hold"; }
  std::string_view operator()(const std::unique_ptr<chain::OdeKernel>&) const {
    return "collocation on each hold";
  }
  std::string_view operator()(const std::unique_ptr<chain::MemoryKernel>&) const {
    return "memory, node by node";
  }
  std::string_view operator()(const std::unique_ptr<chain::SampledKernel>&) const { return "edge by edge"; }
  template <class T>
  std::string_view operator()(const std::unique_ptr<T>&) const {
    return "value by value";
  }
};

Result run_holds(const chain::Chain& chain, const SampledInput& input, Start start, std::size_t oversample) {
  RecordOptions options{.start = start, .oversample = oversample, .start_s = input.start_s};
  RecordSimulator simulator(chain, input.step_s, options);
  Result out;
  out.y = simulator.run_once(input.u);
  if (simulator.diverged()) {
    throw RunsAway(
        "the model's output grows without bound for this input, expected a stable model (check its spring "
        "and drag)");
  }
  out.stats.engine = Engine::record;
  out.stats.degree = simulator.degree();
  out.stats.steps = input.size() * oversample;
  out.model_error = simulator.model_error();
  out.error_estimate = simulator.rounding_error(out.y);
  return out;
}

/// Whether corners of the input reach memory between samples, all at the same place in their interval: behind a delay of no whole
/// number of samples, and nothing that smooths them in between. Halving the step may then leave each next to the same node as
/// before, which would pass for convergence.
bool hides_corners(const chain::Chain& chain, double step_s) {
  double delay_s = 0.0;
  for (const chain::Block& block : chain.blocks) {
    const chain::Kernel kernel = block.kernel();
    const double samples = delay_s / step_s;
    if (const auto* linear = std::get_if<chain::LinearKernel>(&kernel)) {
      delay_s = linear->order() > 0 && linear->d == 0.0 ? 0.0 : delay_s + linear->delay_s;
    } else if (const auto* ode = std::get_if<std::unique_ptr<chain::OdeKernel>>(&kernel)) {
      if ((*ode)->linear().d == 0.0) delay_s = 0.0;
    } else if (std::holds_alternative<std::unique_ptr<chain::MemoryKernel>>(kernel) &&
               std::abs(samples - std::round(samples)) > 1e-9 * std::max(samples, 1.0)) {
      return true;
    }
  }
  return false;
}

class RecordEngine final : public ChainEngine {
 public:
  Engine which() const override { return Engine::record; }
  std::string_view method(const chain::Kernel& kernel) const override {
    return std::visit(RecordMethod{}, kernel);
  }
  std::variant<Result, NoClosedForm> run(const chain::Chain& chain, const TimeRecord& input,
                                         const Options& options) const override {
    return run_holds(chain, input, start_of(chain, options.start), options.oversample);
  }
  double estimate_error(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                        const Result& result) const override {
    if (result.error_estimate) return *result.error_estimate;  // exact but for rounding
    const Result finer = run_holds(chain, input, start_of(chain, options.start), 2 * options.oversample);
    const double halved = error_figures(result.y, finer.y).max;
    if (!hides_corners(chain, input.step_s)) return halved;
    Options once = options;
    once.estimate_error = false;
    const std::optional<Result> by_events = second_opinion(chain, input, once);
    return by_events ? std::max(halved, error_figures(result.y, by_events->y).max) : halved;
  }
};

}  // namespace

BODESMITH_ENTRY(ChainEngine, record_engine, RecordEngine)

Result run_record(const chain::Chain& chain, const SampledInput& input, const Options& options) {
  return run_holds(chain, input, start_of(chain, options.start), options.oversample);
}

RefinedRecord run_record_refined(const chain::Chain& chain, const TimeRecord& input, const Options& options) {
  constexpr std::size_t kMaxHolds = 4'000'000;
  constexpr std::size_t kMaxOversample = 256;
  RefinedRecord out;
  std::size_t oversample = options.oversample;
  out.result = run_holds(chain, input, start_of(chain, options.start), oversample);
  if (out.result.error_estimate) return out;  // exact but for rounding
  Progress progress("half the step");
  while (true) {
    stop_if_interrupted();
    progress.at(0.0, 1.0);
    Result finer = run_holds(chain, input, start_of(chain, options.start), 2 * oversample);
    const double difference = error_figures(out.result.y, finer.y).max;
    double size = 0.0;
    for (const double y : finer.y) size = std::max(size, std::abs(y));
    out.result.y = std::move(finer.y);
    out.result.stats.steps += finer.stats.steps;
    out.result.error_estimate = difference;
    oversample *= 2;
    if (difference <= std::max(options.absolute_tolerance, options.relative_tolerance * size)) {
      if (hides_corners(chain, input.step_s)) out.outcome = RefinedRecord::Outcome::corners_hidden;
      return out;
    }
    if (input.size() * 2 * oversample > kMaxHolds || oversample >= kMaxOversample) {
      out.outcome = RefinedRecord::Outcome::smallest_step;
      return out;
    }
  }
}

}  // namespace bodesmith::simulate
