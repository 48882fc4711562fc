#include "base/json.hpp"
#include "base/json_header.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "project/filter_run.hpp"
#include "project/run.hpp"
#include "project/run_summary.hpp"

namespace bodesmith::cli {

int run_run(const std::vector<std::string>& arguments) {
  CommandLine line(
      "run", "bodesmith run examples/nanopositioner/project.toml -o out/nanopositioner",
      "Runs a whole project: from target points, fit, approximation, hardware, plant and references to track\n"
      "to cascade, sections, FPAA plan, SPICE netlists, multiplier layout, a tracking study and report.html,\n"
      "a page that opens offline. A project without a disturbance (an audio curve, a filter, a fractional PID) goes\n"
      "from its target to sections, board, circuit and tolerances. Exit status 1 when a limit of the project is not met.");
  line.positional("PROJECT.toml", 1, 1);
  line.output("folder for every output file");
  if (!line.parse(arguments)) return kDone;

  if (project::FilterProject::is_one(line.files().front())) {
    const project::FilterRun run = project::run_filter_project(line.files().front(), line.output_path());
    Json summary = json_header("run", run.from);
    summary.update(project::filter_json(run));
    print_summary(line, project::filter_summary(run), summary);
    return run.limits_met() ? kDone : kLimitMissed;
  }
  const project::ProjectRun run = project::run_project(line.files().front(), line.output_path());
  Json summary = json_header("run", run.from);
  summary.update(project::run_json(run));
  print_summary(line, project::run_summary(run), summary);
  return run.limits_met() ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
