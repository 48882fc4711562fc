#include <fmt/format.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/board_picture.hpp"
#include "fpaa/build_sheet.hpp"
#include "fpaa/error_budget.hpp"
#include "fpaa/plan.hpp"
#include "fpaa/zrna_script.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

int plan_board(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa", "bodesmith fpaa sections.json -o out/fpaa --clock-hz 2000",
      "Turns sections into the CAMs of an FPAA board: clocks, capacitors, places, wires; writes plan.json\n"
      "and a build sheet to type from.\n\n"
      "With a finished plan (each has its own --help):\n"
      "  bodesmith fpaa streams PLAN.json --api ApiCode.c -o DIR   update streams for the board\n"
      "  bodesmith fpaa verify PLAN.json STREAM… --api ApiCode.c   decodes streams, compares with the plan\n"
      "  bodesmith fpaa check PLAN.json REPORT.htm                 compares AnadigmDesigner2's report\n"
      "  bodesmith fpaa controller DISTURBANCE.json -o DIR         the whole controller on the board\n"
      "  bodesmith fpaa send PACKETS.bin --port DEVICE             sends packets to the board");
  line.positional("SECTIONS.json", 1, 1);
  line.output("folder for plan.json, build_sheet.md, build_sheet.html and board.svg");
  line.options().add_options()("board", po::value<std::string>()->default_value("an231k04-quad4"),
                               "the board")(
      "clock-hz", po::value<double>(), "clock of all filters (default: the best of the legal divider tree)")(
      "from-hz", po::value<double>(), "lower end of the band in which errors are minimised and stated")(
      "to-hz", po::value<double>(), "its upper end")("max-error-percent", po::value<double>(),
                                                     "exit with 1 when the complex error is above this");
  line.seed();
  if (!line.parse(arguments)) return kDone;

  Provenance from;
  const std::string file = line.files()[0];
  const Sections sections = Sections::read(file, from);
  fpaa::PlanOptions options;
  options.board = line.get<std::string>("board");
  if (line.has("clock-hz")) options.clock = Hertz{line.positive("clock-hz")};
  if (line.has("from-hz") != line.has("to-hz")) line.fail("--from-hz and --to-hz go together");
  if (line.has("from-hz")) options.band = Band{{line.positive("from-hz")}, {line.positive("to-hz")}};

  const Stopwatch watch;
  const fpaa::Plan plan = [&] {
    try {
      return fpaa::make_plan(sections, options);
    } catch (const DesignError& error) {
      throw DesignError(fmt::format("{}: {}", file, error.what()));
    }
  }();
  const double seconds = watch.seconds();

  Json json = json_header("fpaa_plan", from);
  json.update(plan.to_json());
  fpaa::BudgetOptions budget_options;
  budget_options.seed = line.seed_value();
  const fpaa::ErrorBudget budget = fpaa::error_budget(plan, sections, budget_options);
  json["budget"] = budget.to_json();
  json["timing_s"] = {{"compute", seconds}};
  OutputSet out(line.output_path());
  out.add("plan.json", to_text(json));
  out.add("build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("build_sheet.html", fpaa::build_sheet_html(plan));
  out.add("board.svg", fpaa::board_picture_svg(plan));
  if (plan.chips.size() == 1) out.add("zrna.py", fpaa::zrna_script(plan));
  out.commit();

  int exit = kDone;
  bool met = true;
  if (const auto limit = line.maybe<double>("max-error-percent")) {
    met = plan.error.max_complex_percent <= *limit;
    if (!met) exit = kLimitMissed;
  }
  const auto cams = plan.cams();
  Json summary = json_header("fpaa_summary", from);
  summary["board"] = plan.board;
  summary["clock_hz"] = cams[0]->clock_a.value;
  summary["cams"] = cams.size();
  summary["chips"] = plan.chips.size();
  summary["error"] = json["error"];
  summary["error_with_delays"] = json["error_with_delays"];
  summary["mismatch"] = json["budget"]["mismatch"];
  summary["largest_input_v"] = plan.largest_input_v;
  summary["limits_met"] = met;
  summary["timing_s"] = json["timing_s"];
  const std::string text = fmt::format(
      "{} CAMs on {} chip{} of {}, clock {} Hz\n"
      "worst complex error {} to {} Hz: {} % ({} dB, {} deg) at {} Hz\n"
      "with the output hold: {} % ({} deg)\n"
      "0.1 % capacitor mismatch adds (95 %): {} %\n"
      "largest input: {} V\n{}"
      "written to {}\n",
      cams.size(), plan.chips.size(), plan.chips.size() == 1 ? "" : "s", plan.board,
      rounded_text(cams[0]->clock_a.value, 7), rounded_text(plan.error.band.from.value),
      rounded_text(plan.error.band.to.value), rounded_text(plan.error.max_complex_percent),
      rounded_text(plan.error.max_magnitude_db), rounded_text(plan.error.max_phase_deg),
      rounded_text(plan.error.worst.value), rounded_text(plan.error_with_delays.max_complex_percent),
      rounded_text(plan.error_with_delays.max_phase_deg), rounded_text(budget.mismatch.p95_percent, 3),
      rounded_text(plan.largest_input_v),
      met ? ""
          : fmt::format("NOT met: the complex error is above {} %\n",
                        *line.maybe<double>("max-error-percent")),
      line.output_path().string());
  print_summary(line, text, summary);
  return exit;
}

}  // namespace

int run_fpaa_streams(const std::vector<std::string>& arguments);
int run_fpaa_verify(const std::vector<std::string>& arguments);
int run_fpaa_check(const std::vector<std::string>& arguments);
int run_fpaa_send(const std::vector<std::string>& arguments);
int run_fpaa_controller(const std::vector<std::string>& arguments);

int run_fpaa(const std::vector<std::string>& arguments) {
  const std::string verb = arguments.empty() ? "" : arguments[0];
  const std::vector<std::string> rest(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
  if (verb == "streams") return run_fpaa_streams(rest);
  if (verb == "verify") return run_fpaa_verify(rest);
  if (verb == "check") return run_fpaa_check(rest);
  if (verb == "controller") return run_fpaa_controller(rest);
  if (verb == "send") return run_fpaa_send(rest);
  return plan_board(arguments);
}

}  // namespace bodesmith::cli
