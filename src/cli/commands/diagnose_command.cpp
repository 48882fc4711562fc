#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "gap/diagnosis.hpp"
#include "gap/report/files.hpp"

namespace bodesmith::cli {
namespace {

std::vector<std::filesystem::path> paths(const CommandLine& line, const char* option) {
  std::vector<std::filesystem::path> out;
  for (const auto& p : line.all<std::string>(option)) out.emplace_back(p);
  return out;
}

/// Of all threads of this program.
double processor_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

void declare_drive(CommandLine& line) {
  line.group("The drive of experiment.csv (what is not said is taken from the training records)");
  line.option<double>("drive-lower", "least value of the drive");
  line.option<double>("drive-upper", "largest value");
  line.option<double>("drive-max-rate", "largest slew rate, per second");
  line.option<double>("drive-seconds", "length");
  line.option<double>("drive-step-s", "time between samples");
}

gap::DriveRequest read_drive(const CommandLine& line) {
  gap::DriveRequest out;
  out.lower = line.maybe<double>("drive-lower");
  out.upper = line.maybe<double>("drive-upper");
  if (out.lower && out.upper && !(*out.lower < *out.upper))
    line.fail("--drive-lower is not below --drive-upper");
  out.max_rate = line.maybe_positive("drive-max-rate");
  out.duration_s = line.maybe_positive("drive-seconds");
  out.step_s = line.maybe_positive("drive-step-s");
  if (out.duration_s && out.step_s && *out.duration_s / *out.step_s > gap::kStretchSamples)
    line.fail(
        fmt::format("--drive-seconds and --drive-step-s make more than {} samples", gap::kStretchSamples));
  return out;
}

/// Of the processor: what somebody waits for. Nine tenths of two cores are kept busy.
constexpr double kHalfAMinuteOnTwoCores = 55.0;

gap::SearchOptions read_options(const CommandLine& line, Progress& progress, const Stopwatch& watch) {
  gap::SearchOptions options;
  options.max_terms = line.get<int>("max-terms");
  if (options.max_terms < 0 || options.max_terms > 20) line.fail("--max-terms is outside 0 to 20");
  options.threads = line.get<int>("threads");
  if (options.threads < 1 || options.threads > 256) line.fail("--threads is outside 1 to 256");
  options.progress = [&progress](double fraction) { progress.at(fraction); };
  options.stop = [] { return interrupted(); };
  constexpr unsigned kWritingUpS = 60;  // a stopped search still measures and writes what it found
  allow_to_stop(kWritingUpS);
  const double max_seconds = line.get<double>("max-seconds");
  if (!(max_seconds > 0.0)) line.fail("--max-seconds is not above 0");
  // Unless a limit was asked for it is one of work: a busy machine, and any number of threads, find what an idle one finds.
  const bool asked = line.has("max-seconds");
  options.late = [&watch, max_seconds, asked] {
    return (asked ? watch.seconds() : processor_seconds()) > max_seconds;
  };
  options.drive = read_drive(line);
  return options;
}

bool has_option(const std::vector<std::string>& arguments, const std::vector<std::string>& options) {
  return std::ranges::any_of(arguments, [&](const std::string& a) {
    return std::ranges::any_of(options,
                               [&](const std::string& o) { return a == o || a.starts_with(o + "="); });
  });
}

std::string summary_text(const gap::Diagnosis& d, const std::filesystem::path& folder) {
  std::string verdict = to_string(d.verdict);
  std::replace(verdict.begin(), verdict.end(), '_', ' ');
  std::string text = verdict + "\n";
  const auto rms = [&](double value) {
    return d.relative ? rounded_text(100.0 * value) + " %" : rounded_text(value);
  };
  text += fmt::format("  base model: {} rms{} on training, {} on held-out records", rms(d.refitted.train_rms),
                      d.relative ? " of H_model/H_measured - 1" : "", rms(d.refitted.holdout_rms));
  text += d.relative ? "\n" : fmt::format(" ({:.3f} % of range)\n", d.refitted.holdout_percent_of_range);
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    const auto& s = d.steps[k];
    const double before = d.before(k).holdout_rms;
    text += fmt::format(
        "  + {} ({}){}: held-out {} -> {}{}\n", s.effect, s.placed,
        s.tied_with.empty() ? "" : ", indistinguishable from " + join(s.tied_with, ", "), rms(before),
        rms(s.after.holdout_rms),
        s.after.holdout_rms > before ? ", which is more: the held-out records speak against it" : "");
  }
  const std::string floor = d.floor.source == gap::NoiseFloor::Source::unknown
                                ? "unknown"
                                : rms(d.floor.rms) + " (" + to_string(d.floor.source) + ")";
  text += fmt::format("  noise floor: {}\n", floor);
  if (!d.advice.empty()) text += "  " + d.advice + "\n";
  text += fmt::format("wrote {}\n", (folder / "diagnosis.json").string());
  return text;
}

}  // namespace

void diagnose_into(const std::filesystem::path& folder, const std::filesystem::path& model,
                   const std::filesystem::path& data, const std::filesystem::path& holdout,
                   const gap::SearchOptions& options) {
  Provenance from;
  const auto base = chain::read_model(model, from);
  const auto study = gap::Study::read({data}, {holdout}, base, from);
  OutputSet files(folder);
  gap::add_diagnosis_files(gap::diagnose(base, study, options), study, base, from, files);
  files.commit();
}

int run_diagnose(const std::vector<std::string>& arguments) {
  if (has_option(arguments, {"--circuit", "--plan"})) return run_diagnose_board(arguments);
  if (has_option(arguments, {"--course"})) return run_diagnose_course(arguments);
  CommandLine line(
      "diagnose", "bodesmith diagnose model.toml --data train.csv --holdout test.csv -o out/gap",
      "Names what a model is missing: where it disagrees with measured records, which effect explains it, "
      "and how far the gap shrinks on records that were not fitted.\n"
      "  bodesmith diagnose --circuit circuit.json --data bode.csv -o DIR   which part of a built board is wrong\n"
      "  bodesmith diagnose --course examples/course                        ten hidden effects to try it on");
  line.positional("MODEL.toml|SECTIONS.json", 1, 1);
  line.output(
      "folder for diagnosis.json, model.toml, base_refitted.toml, report.html and, after a tie or with an open "
      "parameter, experiment.csv");
  line.seed();
  line.list<std::string>("data", "records to fit: time_s,u,y or frequency_hz,magnitude_db,phase_deg");
  line.list<std::string>(
      "holdout",
      "records that are not fitted, best with another excitation; none: 30 % of each record is held out");
  line.option<int>("max-terms", "largest number of effects to name", 5);
  line.option<double>(
      "max-seconds",
      "time after which the best so far is kept and nothing new is started (by default of the processor, so that "
      "a busy machine finds the same)",
      kHalfAMinuteOnTwoCores);
  line.option<int>("threads", "threads of the search (the result does not depend on it)", 2);
  declare_drive(line);
  line.reads_records();
  if (!line.parse(arguments)) return kDone;
  const auto data = paths(line, "data");
  if (data.empty()) line.fail("--data is missing, expected at least one CSV file");

  Provenance from = line.new_provenance();
  const auto base = chain::read_model(line.files()[0], from);
  const auto study = gap::Study::read(data, paths(line, "holdout"), base, from);
  Progress progress("looking for what is missing");
  const Stopwatch watch;
  const auto diagnosis = gap::diagnose(base, study, read_options(line, progress, watch));

  const std::filesystem::path folder = line.output_path();
  OutputSet files(folder);
  const Json json = gap::add_diagnosis_files(diagnosis, study, base, from, files);
  files.commit();
  print_summary(line, summary_text(diagnosis, folder), json);
  return diagnosis.verdict == gap::Verdict::interrupted ? kInterrupted : kDone;
}

}  // namespace bodesmith::cli
