#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/shared_options.hpp"
#include "invert/compensation.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {

namespace {

using invert::Compensation;

std::string drive_csv(const TimeRecord& reference, const Compensation& drive) {
  CsvWriter csv;
  csv.add(column::time_s, reference.times_s());
  csv.add(column::reference, reference.u);
  csv.add(column::input, drive.drive);
  return csv.text();
}

Json figures_json(const ErrorFigures& error) {
  return {{"rms", error.rms},
          {"max", error.max},
          {"rms_percent_of_range", error.rms_percent},
          {"max_percent_of_range", error.max_percent}};
}

invert::Options read_compensate_options(const CommandLine& line, const chain::Chain& model) {
  invert::Options options;
  options.preview = !line.has("no-preview");
  options.start = line.has("start")
                      ? line.choice("start", {simulate::Start::equilibrium, simulate::Start::zero})
                      : model.start.value_or(options.start);
  options.limits.lower = line.maybe<double>("lower");
  options.limits.upper = line.maybe<double>("upper");
  for (const auto& [name, limit] :
       {std::pair{"lower", options.limits.lower}, {"upper", options.limits.upper}}) {
    if (limit && !std::isfinite(*limit))
      line.fail(fmt::format("--{} is {}, expected a number", name, *limit));
  }
  if (options.limits.lower && options.limits.upper && !(*options.limits.lower < *options.limits.upper))
    line.fail("--lower is not below --upper");
  options.limits.max_rate_per_s = line.maybe_positive("max-rate");
  if (const auto bandwidth = line.maybe_positive("bandwidth-hz")) options.bandwidth = Hertz{*bandwidth};
  return options;
}

/// Everything that is said of a drive.
struct DriveStatement {
  const chain::Chain& model;
  const TimeRecord& reference;
  const invert::Options& options;
  const Compensation& found;
  invert::SteadyState settled;
  ErrorFigures error;  ///< settled part
  ErrorFigures whole;
  SignalExtent drive;

  /// With what the model missed on its records, which is independent of what the inverse misses on the model.
  std::optional<double> expected_rms() const {
    if (!model.trained) return std::nullopt;
    return std::hypot(error.rms, model.trained->rms());
  }
  Json json() const;
  std::string text() const;
  void warn() const;
};

Json DriveStatement::json() const {
  Json out = {{"samples", reference.size()},
              {"start", std::string(simulate::to_string(options.start))},
              {"out_of_reach", found.samples_out_of_reach},
              {"out_of_reach_parts", Json::array()}};
  for (const invert::OutOfReach& one : found.out_of_reach)
    out["out_of_reach_parts"].push_back(
        {{"why", one.why}, {"samples", one.samples}, {"from_s", one.from_s}, {"to_s", one.to_s}});
  out["delay_s"] = found.delay_s;
  out["steps"] = found.steps;
  out["without_inverse"] = found.without_inverse;
  out["percent_of_range"] = kPercentOfRange;
  out["predicted_error"] = figures_json(error);
  out["predicted_error"]["from_s"] = reference.time_s(settled.first);
  out["predicted_error"]["counted"] = settled.why;
  out["predicted_error"]["what"] = "the inverse's, on the model";
  out["predicted_error_whole"] = figures_json(whole);
  if (found.error_estimate) out["simulation_error_estimate"] = *found.error_estimate;
  if (const auto rms = expected_rms()) {
    out["expected_error"] = {{"rms", *rms}, {"model_rms", model.trained->rms()}};
    if (error.range > 0.0) out["expected_error"]["rms_percent_of_range"] = 100.0 * *rms / error.range;
    out["expected_error"]["what"] = model.trained->holdout_rms
                                        ? "tracking, with what the model missed on held-out records"
                                        : "tracking, with what the model missed on its training records";
  }
  out["drive"] = {{"lower", drive.lower},
                  {"upper", drive.upper},
                  {"max_rate_per_s", drive.max_rate_per_s},
                  {"to_hz", drive.to_hz}};
  return out;
}

std::string DriveStatement::text() const {
  std::string out = fmt::format(
      "the inverse's error on the model: rms {} ({} % of range), max {} ({} %)\n"
      "  ({}, from {} s; over the whole record rms {}; as simulate --start {} finds it)\n",
      rounded_text(error.rms), rounded_text(error.rms_percent, 3), rounded_text(error.max),
      rounded_text(error.max_percent, 3), settled.why, rounded_text(reference.time_s(settled.first)),
      rounded_text(whole.rms), simulate::to_string(options.start));
  if (const auto rms = expected_rms()) {
    out += fmt::format(
        "expected tracking error: rms {}{}, with the {} that the model missed on {} records\n",
        rounded_text(*rms),
        error.range > 0.0 ? fmt::format(" ({} % of range)", rounded_text(100.0 * *rms / error.range, 3)) : "",
        rounded_text(model.trained->rms()), model.trained->holdout_rms ? "held-out" : "its training");
  } else {
    out += "expected tracking error: not known, the model does not say what it missed on a record\n";
  }
  out += fmt::format("drive from {} to {}, by up to {} a second; percentages {}\n", rounded_text(drive.lower),
                     rounded_text(drive.upper), rounded_text(drive.max_rate_per_s), kPercentOfRange);
  return out;
}

void DriveStatement::warn() const {
  for (const invert::OutOfReach& one : found.out_of_reach)
    note(fmt::format("warning: {} of {} samples exceed what the model can reach: {} ({} s to {} s)",
                     one.samples, reference.size(), one.why, rounded_text(one.from_s),
                     rounded_text(one.to_s)));
  if (!model.trained) return;
  const auto [low, high] = std::minmax_element(reference.u.begin(), reference.u.end());
  for (const std::string& text : model.trained->beyond(drive, *low, *high))
    note("warning: beyond what the model was fitted to: " + text);
}

void describe_compensate(CommandLine& line) {
  line.option<std::string>(
      "reference",
      "required output: CSV time_s,r, or one that is made: triangle, sine, stair (or steps), "
      "multisine, chirp, complex");
  line.group("Of a reference that is made");
  add_reference_options(line, UsualLength::periods);
  line.seed();
  line.group("Of the drive");
  line.option<std::string>("inverse",
                           "also write the inverse itself (TOML): feedforward of simulate's controller.toml");
  line.flag("no-preview", "do not look ahead by the model's delays (the output then lags by them)");
  line.option<std::string>(
      "start",
      "the model before the first sample: equilibrium (at rest under it) or zero (default: "
      "what the model's own start says, otherwise equilibrium)");
  line.words("start", {"equilibrium", "zero"});
  line.option<double>("lower", "lowest drive");
  line.option<double>("upper", "highest drive");
  line.option<double>("max-rate", "largest slew rate of the drive, per second");
  line.option<double>("bandwidth-hz", "no component of the drive above this (except what the limits add)");
  line.option<double>("skip-s",
                      "seconds at the start that the stated error does not count (default: all but the last "
                      "period of a reference that repeats, otherwise the start alone)");
  line.flag("beyond-training",
            "write a drive that leaves the training records' range by more than a tenth of it, too");
  line.option<double>("max-error-percent", "exit with 1 when the predicted RMS error is larger");
  line.positional("MODEL.toml", 1, 1);
  line.output("file for the drive: CSV time_s,r,u");
}

/// The file, or a reference that is made: over nine tenths of what the model's records reached where nothing else is said.
TimeRecord read_wanted(const CommandLine& line, const chain::Chain& model, Provenance& from) {
  const std::string wanted = line.get<std::string>("reference");
  if (!names_a_reference(wanted)) return TimeRecord::read_csv_column(wanted, from, column::reference);
  simulate::ReferenceSpec spec = read_reference_options(line, wanted, UsualLength::periods);
  if (model.trained && !line.has("amplitude") && !line.has("offset")) {
    constexpr double kShare = 0.9;
    spec.amplitude = kShare * 0.5 * (model.trained->output_upper - model.trained->output_lower);
    spec.offset = 0.5 * (model.trained->output_upper + model.trained->output_lower);
    note(fmt::format(
        "the reference runs from {} to {}, nine tenths of what the model's records reached (--amplitude, "
        "--offset)",
        rounded_text(spec.offset - spec.amplitude), rounded_text(spec.offset + spec.amplitude)));
  }
  return simulate::make_reference(spec);
}

/// DesignError where the drive is not worth writing: worse than none, or a guess.
void require_useful(const CommandLine& line, const DriveStatement& drive) {
  const std::string file = line.files().front();
  const bool beyond_allowed = line.has("beyond-training");
  double mean = 0.0, spread = 0.0;
  const auto counted = std::span(drive.reference.u).subspan(drive.settled.first);
  for (const double r : counted) mean += r / static_cast<double>(counted.size());
  for (const double r : counted) spread += (r - mean) * (r - mean) / static_cast<double>(counted.size());
  // Limits that were asked for may leave a drive nothing to do, a delay that is left is no miss, and
  // --max-error-percent judges by itself.
  if (spread > 0.0 && drive.error.rms > std::sqrt(spread) && !drive.options.limits.any() &&
      drive.options.preview && !line.has("max-error-percent"))
    throw DesignError(
        file, 0,
        fmt::format(
            "no drive was found that follows the reference: {} % of range is left, more than under a "
            "constant drive{}",
            rounded_text(drive.error.rms_percent, 3),
            drive.found.out_of_reach.empty() ? "" : " (" + drive.found.out_of_reach.front().why + ")"));
  if (!drive.model.trained || beyond_allowed) return;
  if (const std::string how = drive.model.trained->far_beyond(drive.drive); !how.empty())
    throw DesignError(file, 0,
                      how +
                          ": expected a reference within what they reached, limits (--lower, --upper), or "
                          "--beyond-training");
}

/// inverse.toml, which names the model relative to itself.
std::string inverse_text(const CommandLine& line, const invert::Options& options) {
  const std::filesystem::path folder =
      std::filesystem::absolute(line.get<std::string>("inverse")).lexically_normal().parent_path();
  const std::filesystem::path model = std::filesystem::absolute(line.files().front()).lexically_normal();
  return invert::InverseFile::text(model.lexically_relative(folder).generic_string(), options);
}

}  // namespace

int run_compensate(const std::vector<std::string>& arguments) {
  CommandLine line(
      "compensate", "bodesmith compensate model.toml --reference triangle --frequency-hz 10 -o drive.csv",
      "The drive that makes the model follow a required trajectory (time_s,r), and the tracking\n"
      "error that is left: block by block where blocks have inverses, the rest numerically on\n"
      "the model's own simulation, within limits of the drive.");
  describe_compensate(line);
  line.reads_records();
  if (!line.parse(arguments)) return kDone;
  if (!line.has("reference"))
    line.fail("--reference is missing, expected a CSV with time_s,r, or triangle, sine, stair, …");
  const std::optional<double> limit = line.maybe_positive("max-error-percent");

  Provenance from = line.new_provenance();
  const chain::Chain model = chain::read_model(line.files().front(), from);
  const invert::Options options = read_compensate_options(line, model);
  if (model.blocks.empty()) throw InputError(line.files().front(), 0, "has no block, expected at least one");
  const TimeRecord reference = read_wanted(line, model, from);
  reference.require_measured_sizes();

  const Stopwatch watch;
  const Compensation found = invert::compensate(model, reference, options);
  const double seconds = watch.seconds();
  const invert::SteadyState settled =
      steady_state_of(model, reference, options, line.maybe<double>("skip-s"));
  TimeRecord driven = invert::as_read_back(reference);
  driven.u = found.drive;
  const DriveStatement statement{model,
                                 reference,
                                 options,
                                 found,
                                 settled,
                                 error_figures(found.predicted, reference.u, settled.first),
                                 error_figures(found.predicted, reference.u),
                                 input_extent({&driven, 1})};

  require_useful(line, statement);
  OutputSet files;
  files.add(line.output_path(), drive_csv(reference, found));
  if (line.has("inverse")) files.add(line.get<std::string>("inverse"), inverse_text(line, options));
  files.commit();

  const bool met = !limit || statement.error.rms_percent <= *limit;
  Json json = json_header("compensation", from);
  json.update(statement.json());
  if (limit) json["limit_met"] = met;
  json["timing_s"] = {{"compute", seconds}};
  std::string text = statement.text();
  statement.warn();
  if (!met) text += limit_not_met(*limit, "%");
  return print_summary(line, text, json, met);
}

}  // namespace bodesmith::cli
