#include "simulate/simulate.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "signal/statistics.hpp"
#include "simulate/engines/engine.hpp"
#include "simulate/ode/cvode_solver.hpp"

namespace bodesmith::simulate {
namespace {

void validate(const chain::Chain& chain, const SampledInput& input) {
  if (input.u.empty()) throw InputError("the input record has no samples");
  for (std::size_t i = 0; i < chain.blocks.size(); ++i) {
    if (const auto error = chain.blocks[i].validate()) {
      throw InputError(fmt::format("block {} ({}): {}", i + 1, chain.blocks[i].type_name(), error->text()));
    }
  }
}

Result run_one(Engine which, const chain::Chain& chain, const TimeRecord& input, const Options& options) {
  const Stopwatch watch;
  const ChainEngine& engine = chain_engine(which);
  // The second run, at half the step or a finer tolerance, takes longer.
  Progress progress("simulation");
  progress.at(0.0, options.estimate_error ? 0.4 : 1.0);
  auto outcome = engine.run(chain, input, options);
  if (const auto* none = std::get_if<NoClosedForm>(&outcome)) {
    throw InputError("the model has no closed form for this input: " + none->text);
  }
  Result result = std::get<Result>(std::move(outcome));
  result.stats.compute_s = watch.seconds();
  if (!options.estimate_error) return result;
  progress.at(0.4, 1.0, "simulation again, for its numerical error");
  result.error_estimate = engine.estimate_error(chain, input, options, result);
  return result;
}

Result run_automatic(const chain::Chain& chain, const TimeRecord& input, const Options& options) {
  const Stopwatch watch;
  auto closed = exact_engine().run(chain, input, options);
  Result result;
  if (auto* exact = std::get_if<Result>(&closed)) {
    result = std::move(*exact);
  } else {
    RefinedRecord refined = run_record_refined(chain, input, options);
    result = std::move(refined.result);
    // A kink or jump inside a sample interval lowers the record engine's order; CVODE's events find it.
    // Takes its output where it is the better one, and says so.
    const bool hidden = refined.outcome == RefinedRecord::Outcome::corners_hidden;
    if (hidden || refined.outcome == RefinedRecord::Outcome::smallest_step) {
      // Only for whoever wants to know the error.
      auto by_events = options.estimate_error ? second_opinion(chain, input, options) : std::nullopt;
      if (hidden && by_events) result.error_estimate = error_figures(result.y, by_events->y).max;
      const double record_error = *result.error_estimate;
      const bool better = by_events && *by_events->error_estimate < record_error;
      if (better) result = std::move(*by_events);
      result.notes.push_back(
          (hidden
               ? "corners of the input lie between samples, where a delay moves them, in front of memory; "
               : fmt::format(
                     "from sample to sample the output still changed by {:.2g} when the step was last halved: a "
                     "kink or jump lies inside sample intervals; ",
                     record_error)) +
          (better ? "CVODE took over" : "the engine cvode locates such events"));
    }
  }
  result.stats.compute_s = watch.seconds();
  return result;
}

void expect_finite(const Result& result) {
  for (const double y : result.y) {
    if (!(std::abs(y) <= kLargestOutput))
      throw RunsAway(fmt::format("the model's output goes beyond {} for this input", kLargestOutput));
  }
}

}  // namespace

std::vector<Segment> segments_of(const chain::Chain& chain, Engine engine) {
  std::vector<Segment> out;
  for (std::size_t i = 1; i <= chain.blocks.size(); ++i) {
    const std::string_view method = chain_engine(engine).method(chain.blocks[i - 1].kernel());
    if (!out.empty() && out.back().method == method) {
      out.back().last = i;
    } else {
      out.push_back({i, i, method});
    }
  }
  return out;
}

Result simulate(const chain::Chain& chain, const TimeRecord& input, const Options& options) {
  validate(chain, input);
  Result result = options.engine == Engine::automatic ? run_automatic(chain, input, options)
                                                      : run_one(options.engine, chain, input, options);
  expect_finite(result);
  return result;
}

Result simulate(const chain::Chain& chain, const SampledInput& input, const Options& options) {
  if (options.engine != Engine::record || options.estimate_error) {
    TimeRecord record;
    record.start_s = input.start_s;
    record.step_s = input.step_s;
    record.u.assign(input.u.begin(), input.u.end());
    return simulate(chain, record, options);
  }
  validate(chain, input);
  const Stopwatch watch;
  Result result = run_record(chain, input, options);
  result.stats.compute_s = watch.seconds();
  expect_finite(result);
  return result;
}

std::string_view to_string(Engine engine) {
  constexpr std::array kWords = {"automatic", "record", "exact", "cvode", "grunwald-letnikov"};
  return kWords.at(static_cast<std::size_t>(engine));
}

Options Options::finer() const {
  Options out = *this;
  out.relative_tolerance *= 0.1;
  out.absolute_tolerance *= 0.1;
  return out;
}

void require_few_edges(double edges, std::string_view what, double most) {
  if (edges <= most) return;
  throw InputError(fmt::format("{} has {} edges within the record, expected at most {}", what,
                               rounded_text(edges, 3), rounded_text(most)));
}

}  // namespace bodesmith::simulate
