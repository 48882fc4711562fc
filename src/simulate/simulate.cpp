#include "simulate/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "simulate/cvode_engine.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::simulate {
namespace {

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

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

}  // namespace

Result simulate(const chain::Chain& chain, const TimeRecord& input, const Options& options) {
  if (input.u.empty()) throw InputError("the input record has no samples");
  for (std::size_t i = 0; i < chain.blocks.size(); ++i) {
    if (const std::string complaint = chain.blocks[i].complaint(); !complaint.empty()) {
      throw InputError(fmt::format("block {} ({}): {}", i + 1, chain.blocks[i].type_name(), complaint));
    }
  }
  Result result;
  const Stopwatch watch;
  if (options.engine == Engine::cvode) {
    result.stats.engine = "cvode";
    try {
      result.y = run_cvode_engine(chain, input, options, result.stats, result.notes, result.model_error);
    } catch (const InputError&) {
      throw;
    } catch (const Interrupted&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw InputError(fmt::format("the model cannot be solved for this input: {}", error.what()));
    }
    result.stats.compute_s = watch.seconds();
    if (options.estimate_error) {
      Options finer = options;
      finer.relative_tolerance *= 0.1;
      finer.absolute_tolerance *= 0.1;
      Stats ignored;
      std::vector<std::string> notes;
      double model_error = 0.0;
      result.error_estimate =
          largest_difference(result.y, run_cvode_engine(chain, input, finer, ignored, notes, model_error));
    }
  } else {
    result.stats.engine = "record";
    result.y = run_record(chain, input, options, options.degree, options.oversample, result);
    result.stats.compute_s = watch.seconds();
    if (options.estimate_error) {
      Result finer;
      result.error_estimate = largest_difference(
          result.y, run_record(chain, input, options, result.stats.degree, 2 * options.oversample, finer));
    }
  }
  for (const double y : result.y) {
    if (!std::isfinite(y)) throw InputError("the model's output is not finite for this input");
  }
  return result;
}

}  // namespace bodesmith::simulate
