// identify and diagnose: models from records, and what they miss.
#include <fmt/format.h>

#include <chrono>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "chain/model_file.hpp"
#include "functions.hpp"
#include "gap/diagnosis.hpp"
#include "gap/report/files.hpp"
#include "hysteresis/model_type.hpp"
#include "identify/record_findings.hpp"
#include "records.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith::python {
namespace {

identify::StageFitOptions fit_options(const Node& o) {
  identify::StageFitOptions out;
  hysteresis::IdentifyOptions& options = out.identify;
  options.seed = seed_of(o);
  if (o.has("method")) options.method = o.at("method").one_of({"best", "paper"});
  options.size = integer_or(o, "size", 0, 0, 2000);
  if (o.has("skip_s")) options.skip_s = o.at("skip_s").non_negative();
  options.frequency_hz = o.has("frequency_hz") ? o.at("frequency_hz").non_negative() : 0.0;
  options.effort = positive_or(o, "effort", 1.0);
  options.asymmetric = o.boolean_or("asymmetric", false);
  out.find_delay = o.boolean_or("find_delay", false);
  if (o.has("delay_s")) out.delay_s = o.at("delay_s").non_negative();
  return out;
}

void expect_outputs(const std::vector<TimeRecord>& records, double skip_s) {
  for (const TimeRecord& record : records) {
    if (record.y.empty()) throw InputError(record.file + " has no y");
    if (record.duration_s() <= skip_s)
      throw InputError(
          fmt::format("{} lasts {} s, expected more than skip_s", record.file, record.duration_s()));
  }
}

/// Time records, or frequency responses: data and holdout of one kind.
gap::Study study_of(const Call& call, const chain::Chain& base) {
  const Node& o = call.options;
  if (!o.has("responses")) {
    std::vector<TimeRecord> data = records_of(call, "data");
    std::vector<TimeRecord> holdout = records_of(call, "holdout");
    expect_outputs(data, 0.0);
    expect_outputs(holdout, 0.0);
    return gap::Study::of(std::move(data), std::move(holdout), base);
  }
  std::vector<FrequencyRecord> data, holdout;
  for (long i = 0; i < o.at("responses").integer(0, 1000); ++i)
    data.emplace_back(response_of(call, fmt::format("_data{}", i)));
  for (long i = 0; i < (o.has("held_out_responses") ? o.at("held_out_responses").integer(0, 1000) : 0); ++i)
    holdout.emplace_back(response_of(call, fmt::format("_holdout{}", i)));
  return gap::Study::of(std::move(data), std::move(holdout), base);
}

}  // namespace

Answer identify_model(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"records", "holdout", "model", "method", "size", "skip_s", "frequency_hz", "effort",
                "asymmetric", "find_delay", "delay_s", "seed"});
  const identify::StageFitOptions options = fit_options(o);
  const std::string name = o.at("model").string();
  const hysteresis::ModelType* type =
      name == "linear" ? nullptr : &hysteresis::model_type_registry().get(name);
  const std::vector<TimeRecord> training = records_of(call, "records");
  const std::vector<TimeRecord> holdout = records_of(call, "holdout");
  if (training.empty()) throw InputError("there is no record");
  expect_outputs(training, options.identify.skip_s);
  expect_outputs(holdout, options.identify.skip_s);
  const identify::RecordFindings findings = identify::find_in_records(training, options.identify, false);
  const identify::StageFit fit = fit_stage(type, training, holdout, options);
  if (!fit.refused.empty()) throw InputError("identify: " + fit.refused);
  const chain::Chain model = identified_model(fit, training, options.identify.skip_s);

  Answer out;
  out.result = to_json(fit);
  out.result["records"] = {{"transient_s", findings.transient_s}, {"notes", findings.notes}};
  if (findings.frequency_hz) out.result["records"]["frequency_hz"] = *findings.frequency_hz;
  out.result["model_text"] = chain::model_text(model);
  out.result["timing_s"] = {{"compute", fit.compute_s}};
  return out;
}

Answer diagnose_model(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"model", "data", "holdout", "responses", "held_out_responses", "max_terms", "threads", "seed",
                "max_seconds"});
  const chain::Chain base = chain::model_from_node(o.at("model"));
  const gap::Study study = study_of(call, base);
  Progress progress("looking for what is missing");
  gap::SearchOptions options;
  options.max_terms = integer_or(o, "max_terms", options.max_terms, 0, 20);
  options.threads = integer_or(o, "threads", options.threads, 1, 256);
  static_cast<void>(seed_of(o));  // nothing is left to chance: any seed finds the same
  options.progress = [&progress](double fraction) { progress.at(fraction); };
  const Stopwatch watch;
  const auto seconds = maybe_positive(o, "max_seconds");
  options.stop = [&watch, seconds] { return interrupted() || (seconds && watch.seconds() > *seconds); };
  const gap::Diagnosis found = gap::diagnose(base, study, options);
  stop_if_interrupted();

  Answer out;
  out.result = document("diagnosis", to_json(found), found.compute_s);
  out.files["model.toml"] =
      chain::model_text(found.search.final.chain(), "The base model, with what was found.");
  out.files["base_refitted.toml"] =
      chain::model_text(found.search.base.chain(), "The base model with its free parameters refitted.");
  out.files["report.html"] = gap::report_page(found, study);
  return out;
}

}  // namespace bodesmith::python
