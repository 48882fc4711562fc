#include "base/documents/json.hpp"
#include "base/progress.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "measured/measured.hpp"
#include "project/run.hpp"
#include "project/sweep/sweep.hpp"

namespace bodesmith::cli {
namespace {

/// Of a search for what is wrong with what was built: names, and seconds.
constexpr int kMeasuredTerms = 3;
constexpr double kMeasuredSeconds = 120.0;

int run_variants(const CommandLine& line) {
  const std::unique_ptr<Team> team = join_team();
  const project::Sweep sweep = project::run_sweep(line.files().front(), line.get<std::string>("sweep"),
                                                  line.output_path(), {.resume = line.has("resume")}, *team);
  if (!team->leads()) return kDone;
  Json summary = json_header("sweep", sweep.from);
  summary.update(project::sweep_json(sweep));
  return print_summary(line, project::sweep_summary(sweep), summary, sweep.limits_met());
}

/// What was built against its prediction; the project is run first where that has not been done.
int run_built(const CommandLine& line, const project::ProjectSource& source) {
  gap::SearchOptions options;
  options.max_terms = kMeasuredTerms;
  options.stop = [] { return interrupted(); };
  const Deadline deadline(line.maybe_positive("max-seconds").value_or(kMeasuredSeconds));
  options.late = [deadline] { return deadline.passed(); };
  const measured::Measured built =
      measured::run_measured(source, line.get<std::string>("measured"), line.output_path(), options);
  Json summary = json_header("measured", built.from);
  summary.update(built.json());
  print_summary(line, built.summary(line.output_path()), summary);
  return kDone;
}

}  // namespace

int run_run(const std::vector<std::string>& arguments) {
  CommandLine line(
      "run", "bodesmith run examples/nanopositioner/project.toml -o out/nanopositioner",
      "Runs a whole project: from target points, fit, approximation, hardware, plant and references to track\n"
      "to cascade, sections, FPAA plan, SPICE netlists, multiplier layout, a tracking study and report.html,\n"
      "a page that opens offline. A project without a disturbance (an audio curve, a filter, a fractional PID) goes\n"
      "from its target to sections, board, circuit and tolerances. Exit status 1 when a limit of the project is not met.\n"
      "With --sweep a table of variants (each changes keys of the project) becomes a folder each and one table,\n"
      "sweep.csv; under `mpirun -n N` the processes share them.\n"
      "With --measured the hardware that was built from -o is compared with its prediction: which part is wrong, and next/.");
  line.positional("PROJECT.toml", 1, 1);
  line.output("folder for every output file");
  line.option<std::string>("sweep",
                           "VARIANTS.toml: the project once for each of its [[variant]] or [grid] designs");
  line.flag("resume", "with --sweep: keep what an earlier one finished with the same files");
  line.option<std::string>(
      "measured",
      "FILE: a response (frequency_hz, magnitude_db, phase_deg) of the circuit built, or a record (time_s, u, y) of\n"
      "controller, stage or both; the project is run first where -o does not hold it");
  line.option<double>(
      "max-seconds",
      "time after which what the design itself does not need (tolerances, other stages, other alternatives'\n"
      "hardware) is left out and reported; not with --sweep");
  if (!line.parse(arguments)) return kDone;
  if (line.has("sweep") && line.has("max-seconds")) line.fail("--max-seconds does not go with --sweep");
  if (line.has("sweep") && line.has("measured")) line.fail("--measured does not go with --sweep");
  if (line.has("sweep")) return run_variants(line);
  if (line.has("resume")) line.fail("--resume goes with --sweep");

  auto source = project::ProjectSource::read(line.files().front());
  if (const auto seconds = line.maybe_positive("max-seconds")) source.deadline = Deadline(*seconds);
  if (line.has("measured")) return run_built(line, source);
  const project::Run run = project::run_project(source, line.output_path());
  Json summary = json_header("run", run.from);
  summary.update(run.json());
  return print_summary(line, run.summary(line.output_path()), summary, run.limits_met());
}

}  // namespace bodesmith::cli
