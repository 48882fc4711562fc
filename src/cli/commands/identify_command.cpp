#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "hysteresis/model_type.hpp"
#include "identify/record_findings.hpp"
#include "identify/stage_fit.hpp"

namespace bodesmith::cli {
namespace {

using identify::StageFit;

std::string figures_text(const ErrorFigures& figures) {
  if (!std::isfinite(figures.rms) || !std::isfinite(figures.rms_percent)) {
    throw InputError(
        "the errors of the model are not finite: the record's numbers are beyond what double precision can square");
  }
  return fmt::format("rms {} ({} % of range), max {} ({} %), rms with the offset free {}",
                     rounded_text(figures.rms), rounded_text(figures.rms_percent, 3),
                     rounded_text(figures.max), rounded_text(figures.max_percent, 3),
                     rounded_text(figures.rms_free_offset));
}

std::string text_of(const StageFit& fit) {
  std::string text = fmt::format("{}: {}\n", fit.model, fit.identified.method);
  text += fmt::format("  training  {}\n", figures_text(fit.training));
  if (fit.holdout) text += fmt::format("  holdout   {}\n", figures_text(*fit.holdout));
  if (fit.stage.delay_s != 0.0) text += fmt::format("  delay     {} s\n", rounded_text(fit.stage.delay_s));
  std::size_t shown = 0;
  for (const auto& one : fit.identified.uncertainty) {
    if (++shown > 24) break;
    text += fmt::format("  {:<14} {:>12} +- {}\n", one.name, rounded_text(one.value, 5),
                        std::isfinite(one.standard_deviation) ? rounded_text(one.standard_deviation, 2)
                                                              : std::string("not determined"));
  }
  for (const std::string& remark : fit.identified.notes) text += "  note: " + remark + "\n";
  if (!fit.identified.converged) text += "  note: the search stopped at its limit, not at a minimum\n";
  text += fmt::format("  time      {} s\n", rounded_text(fit.compute_s, 3));
  return text;
}

std::string table_of(const std::vector<StageFit>& fits, bool with_holdout) {
  std::string text = fmt::format("{:<32} {:>11} {:>8} {:>11} {:>8} {:>12} {:>8}\n", "model", "train rms", "%",
                                 with_holdout ? "holdout rms" : "", with_holdout ? "%" : "",
                                 with_holdout ? "offset free" : "", "time s");
  for (const StageFit& fit : fits) {
    if (!fit.refused.empty()) {
      text += fmt::format("{:<32} refused: {}\n", fit.model, fit.refused);
      continue;
    }
    text += fmt::format("{:<32} {:>11} {:>8} {:>11} {:>8} {:>12} {:>8}\n", fit.model,
                        rounded_text(fit.training.rms), rounded_text(fit.training.rms_percent, 3),
                        fit.holdout ? rounded_text(fit.holdout->rms) : std::string(),
                        fit.holdout ? rounded_text(fit.holdout->rms_percent, 3) : std::string(),
                        fit.holdout ? rounded_text(fit.holdout->rms_free_offset) : std::string(),
                        rounded_text(fit.compute_s, 3));
  }
  return text;
}

double score(const StageFit& fit) {
  return fit.holdout ? fit.holdout->rms : fit.training.rms;
}

constexpr const char* kLinear = "linear";

std::string model_names() {
  return std::string(kLinear) + ", " + hysteresis::model_type_registry().names();
}

/// Null for the straight line.
const hysteresis::ModelType* model_of_name(const std::string& name) {
  return name == kLinear ? nullptr : &hysteresis::model_type_registry().get(name);
}

/// What is asked for.
struct IdentifyRequest {
  bool skip_given = false;
  bool delay_given = false;
  bool all_models = false;
  const hysteresis::ModelType* model = nullptr;  ///< unless all
  bool both_methods = false;
  identify::StageFitOptions options;
  std::optional<double> max_error_percent;

  /// The comparison of several fits, instead of one.
  bool table() const { return all_models || both_methods; }
};

void describe_options(CommandLine& line) {
  const std::string models = "one of " + model_names() + ", or all for the comparison table";
  line.option<std::string>("model", models);
  std::vector<std::string> names = hysteresis::model_type_registry().name_list();
  names.insert(names.end(), {kLinear, "all"});
  line.words("model", std::move(names));
  line.repeatable("holdout", "record that is not fitted, only compared with (repeatable)");
  line.option<std::string>("method", "best, paper (what the model's own paper does), or both in one table",
                           "best");
  line.words("method", {"best", "paper", "both"});
  line.option<int>("size", "plays, operators or levels of the model (0: its default)", 0);
  line.option<std::string>("delay", "none, find, or a pure delay in seconds", "none");
  line.option<double>(
      "skip-s", "seconds at the start of every record that are simulated but not counted (start transients)",
      0.0);
  line.option<double>("frequency-hz", "operating frequency for models that ask for it (0: found)", 0.0);
  line.flag("asymmetric", "prandtl_ishlinskii: with dead zones after the plays");
  line.option<double>("effort", "length of stochastic and iterative searches, relative", 1.0);
  line.option<double>("max-error-percent", "exit with 1 when the RMS error (holdout if given) is larger");
  line.positional("RECORD.csv...", 1, -1);
  line.output("file for the model (with --model all: the best one)", true);
  line.seed();
}

void read_delay(const CommandLine& line, identify::StageFitOptions& options) {
  const std::string delay = line.get<std::string>("delay");
  options.find_delay = delay == "find";
  if (options.find_delay || delay == "none") return;
  double value = 0.0;
  if (!parse_quantity(delay, value) || value < 0.0)
    line.fail(fmt::format("--delay is '{}', expected none, find or seconds", delay));
  options.delay_s = value;
}

IdentifyRequest request_of(CommandLine& line) {
  IdentifyRequest out;
  const std::string models = "one of " + model_names() + ", or all for the comparison table";
  if (!line.has("model")) line.fail("--model is missing, expected " + models);
  const std::string model = line.get<std::string>("model");
  out.all_models = model == "all";
  if (!out.all_models && model != kLinear && hysteresis::model_type_registry().find(model) == nullptr)
    line.fail(fmt::format("--model is '{}'{}, expected {}", model,
                          did_you_mean(model, hysteresis::model_type_registry().name_list()), models));
  if (!out.all_models) out.model = model_of_name(model);
  hysteresis::IdentifyOptions& options = out.options.identify;
  options.seed = line.seed_value();
  options.method = line.get<std::string>("method");
  out.both_methods = options.method == "both";
  if (options.method != "best" && options.method != "paper" && !out.both_methods)
    line.fail(fmt::format("--method is '{}', expected best, paper or both", options.method));
  options.size = line.get<int>("size");
  if (options.size < 0 || options.size > 2000) line.fail("--size is out of range, expected 0 .. 2000");
  options.skip_s = line.get<double>("skip-s");
  out.skip_given = line.has("skip-s");
  out.delay_given = line.has("delay");
  if (!(options.skip_s >= 0.0)) line.fail("--skip-s is below 0, expected seconds");
  options.frequency_hz = line.get<double>("frequency-hz");
  if (!(options.frequency_hz >= 0.0)) line.fail("--frequency-hz is below 0, expected hertz");
  options.effort = line.positive("effort");
  options.asymmetric = line.has("asymmetric");
  read_delay(line, out.options);
  out.max_error_percent = line.maybe_positive("max-error-percent");
  return out;
}

std::vector<TimeRecord> read_records(const std::vector<std::string>& files, double skip_s, Provenance& from) {
  std::vector<TimeRecord> out;
  for (const std::string& file : files) {
    out.push_back(TimeRecord::read_csv(file, from, true));
    if (out.back().duration_s() <= skip_s)
      throw InputError(
          out.back().file, 0,
          fmt::format("lasts {} s, expected more than --skip-s", number_text(out.back().duration_s())));
  }
  return out;
}

/// Every model (or the one) by every method asked for; those that the records cannot determine with the reason.
std::vector<StageFit> fit_table(IdentifyRequest request, const std::vector<TimeRecord>& training,
                                const std::vector<TimeRecord>& holdout) {
  identify::StageFitOptions& options = request.options;
  if (options.find_delay) options.delay_s = identify::best_delay(training, options.identify, false);
  std::vector<const hysteresis::ModelType*> models{request.model};
  if (request.all_models) {
    const auto& types = hysteresis::model_type_registry().all();
    models = {nullptr};
    models.insert(models.end(), types.begin(), types.end());
  }
  std::vector<std::string> methods{options.identify.method};
  if (request.both_methods) methods = {"paper", "best"};
  std::vector<StageFit> fits;
  for (const hysteresis::ModelType* model : models) {
    for (const std::string& method : methods) {
      options.identify.method = method;
      try {
        fits.push_back(identify::fit_stage(model, training, holdout, options));
      } catch (const InputError& error) {
        fits.push_back({});
        fits.back().model = model == nullptr ? kLinear : model->name();
        fits.back().refused = error.what();
      }
      if (request.both_methods) fits.back().model += fmt::format(" ({})", method);
    }
  }
  return fits;
}

bool for_steady_sines(const StageFit& fit) {
  return fit.stage.model.type != nullptr && fit.stage.model.type->for_steady_sines();
}

/// The one with the smallest error, models of steady sines only where there is no other. Throws InputError when no
/// model fits.
const StageFit& best_of(const std::vector<StageFit>& fits) {
  const StageFit* best = nullptr;
  for (const bool sines : {false, true}) {
    for (const StageFit& fit : fits) {
      if (!fit.refused.empty() || for_steady_sines(fit) != sines) continue;
      if (best == nullptr || score(fit) < score(*best)) best = &fit;
    }
    if (best != nullptr) break;
  }
  if (best == nullptr) throw InputError("identify: no model fits these records: " + fits.front().refused);
  return *best;
}

/// What is found in the records, used where nothing else was asked for.
identify::RecordFindings findings_of(IdentifyRequest& request, const std::vector<TimeRecord>& training,
                                     const std::vector<TimeRecord>& holdout) {
  hysteresis::IdentifyOptions& options = request.options.identify;
  const bool look_for_delay = request.all_models && !request.delay_given;
  identify::RecordFindings out = identify::find_in_records(training, options, look_for_delay);
  if (!request.all_models) {
    if (out.transient_s > options.skip_s)
      out.notes[0] += fmt::format(" (--skip-s {} leaves them out)", rounded_text(out.transient_s));
    return out;
  }
  if (look_for_delay && out.delay_s > 0.0) request.options.delay_s = out.delay_s;
  double shortest = training[0].duration_s();
  for (const auto* records : {&training, &holdout}) {
    for (const TimeRecord& record : *records) shortest = std::min(shortest, record.duration_s());
  }
  if (!request.skip_given && out.transient_s > 0.0 && out.transient_s < 0.5 * shortest) {
    options.skip_s = out.transient_s;
    out.notes[0] += "; they are not counted";
  }
  return out;
}

std::string model_comment(const StageFit& fit) {
  std::string out = fmt::format(
      "{} by {}\ntraining: {}\n"
      "the errors are for a start at rest under the first input",
      fit.model, fit.identified.method, figures_text(fit.training));
  if (fit.holdout) out += fmt::format("\nholdout: {}", figures_text(*fit.holdout));
  return out;
}

}  // namespace

int run_identify(const std::vector<std::string>& arguments) {
  CommandLine line(
      "identify", "bodesmith identify train.csv --model prandtl_ishlinskii --holdout test.csv -o model.toml",
      "Fits a hysteresis model to measured records (time_s,u,y) and compares it with held-out ones.\n"
      "Errors are RMS and maximum in percent of the record's range (eq. 8 of \"Modeling and Control of\n"
      "Piezoelectric Hysteresis: A Polynomial-Based Fractional Order Disturbance Compensation Approach\").");
  describe_options(line);
  add_disturbance_options(line);
  line.reads_records();
  if (!line.parse(arguments)) return kDone;
  if (line.has("disturbance")) return identify_disturbance_mode(line);
  if (line.has("gains")) line.fail("--gains needs --disturbance");
  if (!line.has("output")) line.fail("-o is missing, expected where to write the result");
  IdentifyRequest request = request_of(line);

  Provenance from = line.new_provenance();
  const double asked_skip_s = request.options.identify.skip_s;
  const std::vector<TimeRecord> training = read_records(line.files(), asked_skip_s, from);
  std::vector<TimeRecord> holdout;
  if (line.has("holdout"))
    holdout = read_records(line.get<std::vector<std::string>>("holdout"), asked_skip_s, from);
  const identify::RecordFindings findings = findings_of(request, training, holdout);
  const double skip_s = request.options.identify.skip_s;

  const std::vector<StageFit> fits =
      request.table() ? fit_table(request, training, holdout)
                      : std::vector{identify::fit_stage(request.model, training, holdout, request.options)};
  const StageFit& best = best_of(fits);
  const chain::Chain model = identify::identified_model(best, training, skip_s);
  write_file(line.output_path(), chain::model_text(model, model_comment(best)));

  Json json = json_header("identification", from);
  json["percent_of_range"] = kPercentOfRange;
  json["records"] = {
      {"transient_s", findings.transient_s}, {"delay_s", findings.delay_s}, {"notes", findings.notes}};
  if (findings.frequency_hz) json["records"]["frequency_hz"] = *findings.frequency_hz;
  json["skip_s"] = skip_s;
  if (request.table()) {
    json["chosen"] = best.model;
    Json list = Json::array();
    for (const StageFit& fit : fits) list.push_back(to_json(fit));
    json["models"] = list;
  } else {
    json.update(to_json(best));
  }
  const std::optional<double> limit = request.max_error_percent;
  const bool met = !limit || (best.holdout ? best.holdout->rms_percent : best.training.rms_percent) <= *limit;
  if (limit) json["limit_met"] = met;
  double seconds = 0.0;
  for (const StageFit& fit : fits) seconds += fit.compute_s;
  json["timing_s"] = {{"compute", seconds}};
  std::string text = request.table()
                         ? table_of(fits, !holdout.empty()) + fmt::format("best: {}\n", best.model)
                         : text_of(best);
  text += fmt::format("percentages {}\n", kPercentOfRange);
  if (request.table()) {
    for (const StageFit& fit : fits) {
      if (&fit != &best && fit.refused.empty() && for_steady_sines(fit) && score(fit) < score(best))
        note(fmt::format(
            "{} fits closest, but is a model of steady sines: its drive for anything else means little",
            fit.model));
    }
  }
  for (const std::string& found : findings.notes) note(found);
  if (!met) text += limit_not_met(*limit, "%");
  return print_summary(line, text, json, met);
}

}  // namespace bodesmith::cli
