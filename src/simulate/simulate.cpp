#include "simulate/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "simulate/cvode_engine.hpp"
#include "simulate/exact_engine.hpp"
#include "simulate/record_metrics.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::simulate {

std::string_view to_string(Engine engine) {
  switch (engine) {
    case Engine::automatic:
      return "automatic";
    case Engine::record:
      return "record";
    case Engine::exact:
      return "exact";
    case Engine::cvode:
      return "cvode";
  }
  return "";
}

std::string_view to_string(Start start) {
  return start == Start::equilibrium ? "equilibrium" : "zero";
}

namespace {

std::vector<double> run_record(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                               int degree, int oversample, Result& result) {
  RecordOptions record;
  record.start = options.start;
  record.degree = degree;
  record.oversample = oversample;
  record.start_s = input.start_s;
  RecordSimulator simulator(chain, input.step_s, record);
  const auto y = simulator.run(input.u);
  result.stats.degree = simulator.degree();
  result.stats.steps = input.size() * static_cast<std::size_t>(oversample);
  result.model_error = simulator.model_error();
  if (simulator.diverged()) {
    throw InputError(
        "the model's output grows without bound for this input, expected a stable model (check its spring "
        "and drag)");
  }
  return {y.begin(), y.end()};
}

/// Halves the step until that no longer changes the output by more than the tolerance; the finest run counts.
/// False when it still does at the smallest step.
bool refine(const chain::Chain& chain, const TimeRecord& input, const Options& options, Result& result) {
  constexpr std::size_t kMostHolds = 4'000'000;
  result.stats.engine = "record";
  int oversample = options.oversample;
  result.y = run_record(chain, input, options, options.degree, oversample, result);
  while (true) {
    stop_if_interrupted();
    Result finer;
    finer.y = run_record(chain, input, options, result.stats.degree, 2 * oversample, finer);
    const double difference = compare_records(result.y, finer.y).max;
    double size = 0.0;
    for (const double y : finer.y) size = std::max(size, std::abs(y));
    result.y = std::move(finer.y);
    result.stats.steps += finer.stats.steps;
    result.error_estimate = difference;
    oversample *= 2;
    const double wanted = std::max(options.absolute_tolerance, options.relative_tolerance * size);
    if (difference <= wanted) return true;
    if (input.size() * static_cast<std::size_t>(2 * oversample) > kMostHolds || oversample >= 256) {
      return false;
    }
  }
}

std::vector<double> run_cvode(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                              Result& result) {
  try {
    return run_cvode_engine(chain, input, options, result.stats, result.notes, result.model_error);
  } catch (const InputError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(fmt::format("the model cannot be solved for this input: {}", error.what()));
  }
}

/// Largest change that a tenth of the tolerance makes.
double cvode_error(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                   const std::vector<double>& y) {
  Options finer = options;
  finer.relative_tolerance *= 0.1;
  finer.absolute_tolerance *= 0.1;
  Result ignored;
  return compare_records(y, run_cvode(chain, input, finer, ignored)).max;
}

/// A kink or jump inside a sample interval lowers the record engine's order; CVODE's events find it. Takes
/// its output where it is the better one, and says so. Only for whoever wants to know the error: it costs two
/// more runs that stop at every corner of the input.
void take_over_in_cvode(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                        Result& result) {
  constexpr std::size_t kMostSamples = 100'000;
  const double record_error = *result.error_estimate;
  Result by_events;
  by_events.stats.engine = "cvode";
  by_events.error_estimate = std::numeric_limits<double>::infinity();
  if (options.estimate_error && input.size() <= kMostSamples) {
    try {
      by_events.y = run_cvode(chain, input, options, by_events);
      by_events.error_estimate = cvode_error(chain, input, options, by_events.y);
    } catch (const InputError&) {
      // Not every chain can be solved so; the record engine's output stands.
    }
  }
  const bool better = *by_events.error_estimate < record_error;
  if (better) result = std::move(by_events);
  result.notes.push_back(
      fmt::format("from sample to sample the output still changed by {:.2g} when the step was last halved: a "
                  "kink or jump "
                  "lies inside sample intervals; {}",
                  record_error, better ? "CVODE took over" : "see --engine cvode"));
}

/// False when there is no closed form; the reason is then the only note.
bool run_exact(const chain::Chain& chain, const TimeRecord& input, const Options& options, Result& result) {
  std::string why_not;
  auto outcome = run_exact_engine(chain, input, options.start, options.engine == Engine::exact, why_not);
  if (!outcome) {
    result.notes = {why_not};
    return false;
  }
  result.y = std::move(outcome->y);
  result.error_estimate = outcome->rounding;
  result.model_error = outcome->model_error;
  result.stats.engine = "exact";
  result.stats.steps = outcome->segments;
  return true;
}

}  // namespace

Result simulate(const chain::Chain& chain, const TimeRecord& input, const Options& options) {
  if (input.u.empty()) throw InputError("the input record has no samples");
  for (std::size_t i = 0; i < chain.blocks.size(); ++i) {
    if (const auto error = chain.blocks[i].validate()) {
      throw InputError(fmt::format("block {} ({}): {}", i + 1, chain.blocks[i].type_name(), error->text()));
    }
  }
  Result result;
  const Stopwatch watch;
  if (options.engine == Engine::cvode) {
    result.stats.engine = "cvode";
    result.y = run_cvode(chain, input, options, result);
    result.stats.compute_s = watch.seconds();
    if (options.estimate_error) result.error_estimate = cvode_error(chain, input, options, result.y);
  } else if (options.engine == Engine::exact ||
             (options.engine == Engine::automatic && run_exact(chain, input, options, result))) {
    if (options.engine == Engine::exact && !run_exact(chain, input, options, result)) {
      throw InputError("the model has no closed form for this input: " + result.notes.front());
    }
    result.stats.compute_s = watch.seconds();
  } else if (options.engine == Engine::record) {
    result.stats.engine = "record";
    result.y = run_record(chain, input, options, options.degree, options.oversample, result);
    result.stats.compute_s = watch.seconds();
    if (options.estimate_error) {
      Result finer;
      result.error_estimate = compare_records(result.y, run_record(chain, input, options, result.stats.degree,
                                                                   2 * options.oversample, finer))
                                  .max;
    }
  } else {
    result.notes.clear();
    if (!refine(chain, input, options, result)) take_over_in_cvode(chain, input, options, result);
    result.stats.compute_s = watch.seconds();
  }
  for (const double y : result.y) {
    if (!std::isfinite(y)) throw InputError("the model's output is not finite for this input");
  }
  return result;
}

}  // namespace bodesmith::simulate
