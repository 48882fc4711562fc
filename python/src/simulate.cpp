// simulate, compensate, references.
#include "simulate/simulate.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"
#include "chain/model_file.hpp"
#include "functions.hpp"
#include "invert/compensation.hpp"
#include "records.hpp"
#include "signal/statistics.hpp"
#include "signal/time_record.hpp"
#include "simulate/controller_file.hpp"
#include "simulate/references.hpp"

namespace bodesmith::python {
namespace {

simulate::Options simulation_options(const Node& o) {
  using simulate::Engine;
  using simulate::Start;
  simulate::Options out;
  out.engine = choice(o, "engine", {Engine::automatic, Engine::exact, Engine::record, Engine::cvode});
  if (o.has("start")) out.start = choice(o, "start", {Start::zero, Start::equilibrium});
  out.relative_tolerance = positive_or(o, "tolerance", out.relative_tolerance);
  out.absolute_tolerance = 1e-2 * out.relative_tolerance;
  out.oversample = static_cast<std::size_t>(integer_or(o, "oversample", 1, 1, 1024));
  out.estimate_error = o.boolean_or("estimate_error", true);
  return out;
}

simulate::LoopSetup loop_of(const Call& call) {
  Provenance from;
  simulate::LoopSetup out = simulate::controller_from_node(call.options.at("controller"), {}, from);
  if (call.options.has("feedforward"))
    out.feedforward = chain::model_from_node(call.options.at("feedforward"));
  if (call.has_array("drive")) {
    out.drive = record_of(call, call.options);
    out.drive->file = "feedforward";
    out.drive->u = call.copy("drive");
  }
  return out;
}

template <class Result>
Json engine_json(const Result& run) {
  Json out = {{"engine", to_string(run.stats.engine)},
              {"steps", run.stats.steps},
              {"model_error_relative", run.model_error},
              {"timing_s", {{"engine", run.stats.compute_s}}}};
  if (run.error_estimate) out["error_estimate"] = *run.error_estimate;
  if (run.stats.degree > 0) out["hold_degree"] = run.stats.degree;
  return out;
}

Json figures_json(const ErrorFigures& error) {
  return {{"rms", error.rms},
          {"max", error.max},
          {"rms_percent_of_range", error.rms_percent},
          {"max_percent_of_range", error.max_percent}};
}

invert::Options compensation_options(const Node& o, const chain::Chain& model) {
  using simulate::Start;
  invert::Options out;
  out.preview = o.boolean_or("preview", true);
  out.start = o.has("start") ? choice(o, "start", {Start::equilibrium, Start::zero})
                             : model.start.value_or(out.start);
  out.limits.lower = maybe_number(o, "lower");
  out.limits.upper = maybe_number(o, "upper");
  if (out.limits.lower && out.limits.upper && !(*out.limits.lower < *out.limits.upper))
    o.at("lower").fail("is not below upper");
  out.limits.max_rate_per_s = maybe_positive(o, "max_rate_per_s");
  if (const auto bandwidth = maybe_positive(o, "bandwidth_hz")) out.bandwidth = Hertz{*bandwidth};
  return out;
}

}  // namespace

Answer simulate_model(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"model", "step_s", "start_s", "engine", "start", "tolerance", "oversample", "estimate_error",
                "controller", "feedforward"});
  const chain::Chain model = chain::model_from_node(o.at("model"));
  const simulate::Options options = simulation_options(o);
  const auto u = call.array("u");
  expect_finite(u, "u");
  if (u.size() < 2) throw InputError("u has fewer than two samples");
  Answer out;
  const Stopwatch watch;
  if (o.has("controller")) {
    simulate::LoopResult run = simulate::simulate_loop(model, loop_of(call), record_of(call, o), options);
    out.result = engine_json(run);
    out.arrays["y"] = std::move(run.y);
    out.arrays["drive"] = std::move(run.drive);
  } else {
    const simulate::SampledInput input(o.number_or("start_s", 0.0), o.at("step_s").positive(), u);
    simulate::Result run = simulate::simulate(model, input, options);
    out.result = engine_json(run);
    out.arrays["y"] = std::move(run.y);
    out.warnings = std::move(run.notes);
  }
  out.result["timing_s"]["compute"] = watch.seconds();
  return out;
}

Answer make_reference(const Call& call) {
  const Node& o = call.options;
  o.allow_only(
      {"kind", "frequency_hz", "last_hz", "amplitude", "offset", "duration_s", "step_s", "steps", "seed"});
  simulate::ReferenceSpec spec;
  spec.kind = o.string_or("kind", spec.kind);
  spec.frequency = Hertz{positive_or(o, "frequency_hz", spec.frequency.value)};
  spec.last = Hertz{positive_or(o, "last_hz", spec.last.value)};
  spec.amplitude = positive_or(o, "amplitude", spec.amplitude);
  spec.offset = o.number_or("offset", spec.amplitude);
  spec.duration_s = positive_or(o, "duration_s", spec.duration_s);
  spec.step_s = positive_or(o, "step_s", spec.step_s);
  spec.steps = integer_or(o, "steps", spec.steps, 1, 1'000'000);
  spec.seed = seed_of(o);
  TimeRecord record = simulate::make_reference(spec);
  Answer out;
  out.result = {{"start_s", record.start_s}, {"step_s", record.step_s}};
  out.arrays["u"] = std::move(record.u);
  return out;
}

Answer compensate_model(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"model", "step_s", "start_s", "preview", "start", "lower", "upper", "max_rate_per_s",
                "bandwidth_hz", "skip_s"});
  const chain::Chain model = chain::model_from_node(o.at("model"));
  if (model.blocks.empty()) throw InputError("the model has no block, expected at least one");
  const invert::Options options = compensation_options(o, model);
  const TimeRecord reference = record_of(call, o);
  const Stopwatch watch;
  invert::Compensation found = invert::compensate(model, reference, options);
  const double seconds = watch.seconds();
  const invert::SteadyState settled = steady_state_of(model, reference, options, maybe_number(o, "skip_s"));
  TimeRecord driven = invert::as_read_back(reference);
  driven.u = found.drive;
  const SignalExtent extent = input_extent({&driven, 1});

  Answer out;
  Json& json = out.result;
  json["predicted_error"] = figures_json(error_figures(found.predicted, reference.u, settled.first));
  json["predicted_error"]["from_s"] = reference.time_s(settled.first);
  json["predicted_error"]["counted"] = settled.why;
  json["predicted_error_whole"] = figures_json(error_figures(found.predicted, reference.u));
  json["delay_s"] = found.delay_s;
  json["steps"] = found.steps;
  json["without_inverse"] = found.without_inverse;
  json["out_of_reach"] = found.samples_out_of_reach;
  json["drive"] = {{"lower", extent.lower},
                   {"upper", extent.upper},
                   {"max_rate_per_s", extent.max_rate_per_s},
                   {"to_hz", extent.to_hz}};
  json["timing_s"] = {{"compute", seconds}};
  for (const invert::OutOfReach& one : found.out_of_reach)
    out.warnings.push_back(std::to_string(one.samples) +
                           " samples exceed what the model can reach: " + one.why);
  if (model.trained) {
    const auto [low, high] = std::minmax_element(reference.u.begin(), reference.u.end());
    for (const std::string& text : model.trained->beyond(extent, *low, *high))
      out.warnings.push_back("beyond what the model was fitted to: " + text);
  }
  out.arrays["u"] = std::move(found.drive);
  out.arrays["predicted"] = std::move(found.predicted);
  return out;
}

}  // namespace bodesmith::python
