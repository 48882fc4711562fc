#include "base/json.hpp"
#include "base/json_header.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "project/whole_way.hpp"

namespace bodesmith::cli {

int run_run(const std::vector<std::string>& arguments) {
  CommandLine line(
      "run", "bodesmith run examples/nanopositioner/project.toml -o out/nanopositioner",
      "The whole way: from a project file (target points, fit, approximation, hardware, plant, references "
      "to\n"
      "track) to cascade, sections, FPAA plan, SPICE netlists, multiplier layout, a tracking study and\n"
      "report.html, a page that opens offline. Exit status 1 when a limit of the project is missed.");
  line.positional("PROJECT.toml", 1, 1);
  line.output("folder for every artefact");
  if (!line.parse(arguments)) return kDone;

  const project::WholeWay way = project::go_the_whole_way(line.files().front(), line.output_path());
  Json summary = json_header("run", way.from);
  summary.update(way.summary_json());
  print_summary(line, way.summary_text(), summary);
  return way.limits_met() ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
