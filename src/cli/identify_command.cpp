#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "hysteresis/registry.hpp"
#include "identify/identify_stage.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;
using hysteresis::ErrorFigures;
using hysteresis::StageFit;

Json to_json(const ErrorFigures& figures) {
  return {{"rms", figures.rms},
          {"max", figures.max},
          {"range", figures.range},
          {"rms_percent_of_range", figures.rms_percent},
          {"max_percent_of_range", figures.max_percent},
          {"rms_free_offset", figures.rms_free_offset}};
}

Json to_json(const StageFit& fit) {
  Json out;
  out["model"] = fit.model;
  if (!fit.refused.empty()) {
    out["refused"] = fit.refused;
    return out;
  }
  out["method"] = fit.identified.method;
  out["converged"] = fit.identified.converged;
  out["training"] = to_json(fit.training);
  if (fit.holdout) out["holdout"] = to_json(*fit.holdout);
  out["delay_s"] = fit.identified.stage.delay_s;
  Json parameters = Json::array();
  for (const auto& one : fit.identified.uncertainty) {
    Json entry = {{"name", one.name}, {"value", one.value}};
    // A parameter that the record does not determine has no finite deviation.
    if (std::isfinite(one.standard_deviation)) entry["standard_deviation"] = one.standard_deviation;
    parameters.push_back(entry);
  }
  out["parameters"] = parameters;
  out["notes"] = fit.identified.notes;
  out["compute_s"] = fit.identified.compute_s;
  return out;
}

std::string figures_text(const ErrorFigures& figures) {
  return fmt::format("rms {} ({} % of range), max {} ({} %), rms with the offset free {}",
                     rounded_text(figures.rms), rounded_text(figures.rms_percent, 3),
                     rounded_text(figures.max), rounded_text(figures.max_percent, 3),
                     rounded_text(figures.rms_free_offset));
}

std::string text_of(const StageFit& fit) {
  std::string text = fmt::format("{}: {}\n", fit.model, fit.identified.method);
  text += fmt::format("  training  {}\n", figures_text(fit.training));
  if (fit.holdout) text += fmt::format("  holdout   {}\n", figures_text(*fit.holdout));
  if (fit.identified.stage.delay_s != 0.0)
    text += fmt::format("  delay     {} s\n", rounded_text(fit.identified.stage.delay_s));
  std::size_t shown = 0;
  for (const auto& one : fit.identified.uncertainty) {
    if (++shown > 24) break;
    text += fmt::format("  {:<14} {:>12} +- {}\n", one.name, rounded_text(one.value, 5),
                        std::isfinite(one.standard_deviation) ? rounded_text(one.standard_deviation, 2)
                                                              : std::string("not determined"));
  }
  for (const std::string& remark : fit.identified.notes) text += "  note: " + remark + "\n";
  if (!fit.identified.converged) text += "  note: the search stopped at its limit, not at a minimum\n";
  text += fmt::format("  time      {} s\n", rounded_text(fit.identified.compute_s, 3));
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
                        rounded_text(fit.identified.compute_s, 3));
  }
  return text;
}

double score(const StageFit& fit) {
  return fit.holdout ? fit.holdout->rms : fit.training.rms;
}

}  // namespace

int run_identify(const std::vector<std::string>& arguments) {
  std::vector<std::string> names{"linear"};
  for (const hysteresis::ModelType& type : hysteresis::model_types()) names.push_back(type.name);

  CommandLine line("identify",
                   "bodesmith identify train.csv --model prandtl_ishlinskii --holdout test.csv -o model.toml",
                   "Fits a hysteresis model to measured records (time_s,u,y) and holds it against others.\n"
                   "Errors are RMS and maximum in percent of the record's range (first seed, eq. 8).");
  const std::string models = "one of " + join(names, ", ") + ", or all for the comparison table";
  line.options().add_options()("model", po::value<std::string>(), models.c_str())(
      "holdout", po::value<std::vector<std::string>>()->composing(),
      "record that is not fitted, only judged (repeatable)")(
      "method", po::value<std::string>()->default_value("best"),
      "best, paper (what the model's own paper does), or both in one table")(
      "size", po::value<int>()->default_value(0), "plays, operators or levels of the model (0: its default)")(
      "delay", po::value<std::string>()->default_value("none"), "none, find, or a pure delay in seconds")(
      "skip-s", po::value<double>()->default_value(0.0),
      "seconds at the start of every record that are simulated but not counted (start transients)")(
      "frequency-hz", po::value<double>()->default_value(0.0),
      "operating frequency for models that ask for it (0: found)")(
      "asymmetric", "prandtl_ishlinskii: with dead zones behind the plays")(
      "effort", po::value<double>()->default_value(1.0),
      "length of stochastic and iterative searches, relative")(
      "max-error-percent", po::value<double>(),
      "exit with 1 when the RMS error (holdout if given) is larger");
  line.positional("RECORD.csv...", 1, -1);
  line.output("where the model goes (with --model all: the best one)");
  line.seed();
  if (!line.parse(arguments)) return kDone;

  if (!line.has("model")) line.fail("--model is missing, expected " + models);
  const std::string model = line.get<std::string>("model");
  if (model != "all" && std::find(names.begin(), names.end(), model) == names.end())
    line.fail(fmt::format("--model is '{}', expected {}", model, models));
  hysteresis::StageFitOptions options;
  options.identify.seed = line.seed_value();
  options.identify.method = line.get<std::string>("method");
  if (options.identify.method != "best" && options.identify.method != "paper" &&
      options.identify.method != "both")
    line.fail(fmt::format("--method is '{}', expected best, paper or both", options.identify.method));
  options.identify.size = line.get<int>("size");
  if (options.identify.size < 0 || options.identify.size > 2000)
    line.fail("--size is out of range, expected 0 .. 2000");
  options.identify.skip_s = line.get<double>("skip-s");
  if (!(options.identify.skip_s >= 0.0)) line.fail("--skip-s is below 0, expected seconds");
  options.identify.frequency_hz = line.get<double>("frequency-hz");
  if (!(options.identify.frequency_hz >= 0.0)) line.fail("--frequency-hz is below 0, expected hertz");
  options.identify.effort = line.positive("effort");
  options.identify.asymmetric = line.has("asymmetric");
  const std::string delay = line.get<std::string>("delay");
  if (delay == "find") {
    options.find_delay = true;
  } else if (delay != "none") {
    double value = 0.0;
    if (!parse_number(delay, value) || value < 0.0)
      line.fail(fmt::format("--delay is '{}', expected none, find or seconds", delay));
    options.delay_s = value;
  }
  std::optional<double> limit;
  if (line.maybe<double>("max-error-percent")) limit = line.positive("max-error-percent");

  Provenance from;
  std::vector<TimeRecord> training, holdout;
  for (const std::string& file : line.files()) training.push_back(TimeRecord::read_csv(file, from, true));
  if (line.has("holdout"))
    for (const std::string& file : line.get<std::vector<std::string>>("holdout"))
      holdout.push_back(TimeRecord::read_csv(file, from, true));
  for (const TimeRecord& record : training)
    if (record.duration_s() <= options.identify.skip_s)
      throw InputError(
          record.file, 0,
          fmt::format("lasts {} s, expected more than --skip-s", number_text(record.duration_s())));
  for (const TimeRecord& record : holdout)
    if (record.duration_s() <= options.identify.skip_s)
      throw InputError(
          record.file, 0,
          fmt::format("lasts {} s, expected more than --skip-s", number_text(record.duration_s())));

  std::vector<StageFit> fits;
  double seconds = 0.0;
  const bool both = options.identify.method == "both";
  const bool table = model == "all" || both;
  if (!table) {
    fits.push_back(hysteresis::fit_stage(model, training, holdout, options));
  } else {
    if (options.find_delay) options.delay_s = hysteresis::best_delay(training, options.identify, false);
    if (model != "all") names = {model};
    for (const std::string& name : names) {
      for (const char* method : {"paper", "best"}) {
        if (!both && method != options.identify.method) continue;
        if (both) options.identify.method = method;
        try {
          fits.push_back(hysteresis::fit_stage(name, training, holdout, options));
        } catch (const InputError& error) {
          fits.push_back({});
          fits.back().model = name;
          fits.back().refused = error.what();
        }
        if (both) fits.back().model += fmt::format(" ({})", method);
      }
    }
  }
  const StageFit* best = nullptr;
  for (const StageFit& fit : fits) {
    seconds += fit.identified.compute_s;
    if (fit.refused.empty() && (best == nullptr || score(fit) < score(*best))) best = &fit;
  }
  if (best == nullptr) throw InputError("identify: no model fits these records: " + fits.front().refused);

  std::vector<std::string> remarks = {
      fmt::format("{} by {}", best->model, best->identified.method),
      fmt::format("training: {}", figures_text(best->training)),
      "the errors are for a start at rest under the first input (simulate --start equilibrium)"};
  if (best->holdout) remarks.push_back(fmt::format("holdout: {}", figures_text(*best->holdout)));
  write_file(line.output_path(), best->identified.stage.to_toml(remarks));

  Json json = json_header("identification", from);
  if (table) {
    json["chosen"] = best->model;
    Json list = Json::array();
    for (const StageFit& fit : fits) list.push_back(to_json(fit));
    json["models"] = list;
  } else {
    json.update(to_json(*best));
  }
  const bool met =
      !limit || (best->holdout ? best->holdout->rms_percent : best->training.rms_percent) <= *limit;
  if (limit) json["limit_met"] = met;
  json["timing_s"] = {{"compute", seconds}};
  std::string text =
      table ? table_of(fits, !holdout.empty()) + fmt::format("best: {}\n", best->model) : text_of(*best);
  if (!met) text += fmt::format("the limit of {} % is NOT met\n", rounded_text(*limit));
  print_summary(line, text, json);
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
