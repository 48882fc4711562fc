#include <fmt/format.h>

#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "identify/compensation.hpp"
#include "identify/error_figures.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::cli {

namespace {

std::string drive_csv(const TimeRecord& reference, const identify::Compensation& drive) {
  CsvWriter csv;
  std::vector<double> time(reference.size());
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = reference.time_s(i);
  csv.add(column::time_s, std::move(time));
  csv.add(column::reference, reference.u);
  csv.add(column::input, drive.drive);
  return csv.text();
}

std::string error_text(const identify::ErrorFigures& error) {
  return fmt::format(
      "predicted tracking error: rms {} ({} % of range), max {} ({} %)\n"
      "(with a perfect model; add the model's own error against the stage)\n",
      rounded_text(error.rms), rounded_text(error.rms_percent, 3), rounded_text(error.max),
      rounded_text(error.max_percent, 3));
}

}  // namespace

int run_compensate(const std::vector<std::string>& arguments) {
  CommandLine line(
      "compensate", "bodesmith compensate model.toml --reference r.csv -o drive.csv",
      "The drive that makes the model follow a required trajectory (time_s,r), by the model's inverse, and\n"
      "the tracking error that is left. Blocks: gain, delay and at most one hysteresis model.");
  line.option<std::string>("reference", "required output, CSV time_s,r");
  line.flag("no-preview", "do not look ahead by the model's delay (a causal drive lags by it)");
  line.option<double>("max-error-percent", "exit with 1 when the predicted RMS error is larger");
  line.positional("MODEL.toml", 1, 1);
  line.output("file for the drive: CSV time_s,r,u");
  if (!line.parse(arguments)) return kDone;
  if (!line.has("reference")) line.fail("--reference is missing, expected a CSV with time_s,r");
  const std::optional<double> limit = line.maybe_positive("max-error-percent");

  Provenance from;
  const identify::StageModel stage = identify::StageModel::read(line.files().front(), from);
  const TimeRecord reference =
      TimeRecord::read_csv_column(line.get<std::string>("reference"), from, column::reference);

  const Stopwatch watch;
  const identify::Compensation drive =
      identify::compensate(stage, reference.u, reference.step_s, !line.has("no-preview"));
  const double seconds = watch.seconds();
  const identify::ErrorFigures error = identify::error_figures(drive.predicted, reference.u);

  write_file(line.output_path(), drive_csv(reference, drive));

  const bool met = !limit || error.rms_percent <= *limit;
  Json json = json_header("compensation", from);
  json["samples"] = reference.size();
  json["out_of_reach"] = drive.out_of_reach;
  json["delay_s"] = stage.delay_s;
  json["predicted_error"] = {{"rms", error.rms},
                             {"max", error.max},
                             {"rms_percent_of_range", error.rms_percent},
                             {"max_percent_of_range", error.max_percent}};
  if (limit) json["limit_met"] = met;
  json["timing_s"] = {{"compute", seconds}};
  std::string text = error_text(error);
  if (drive.out_of_reach > 0)
    note(fmt::format("warning: {} of {} samples ask for more than the model can reach", drive.out_of_reach,
                     reference.size()));
  if (!met) text += limit_not_met(*limit, "%");
  print_summary(line, text, json);
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
