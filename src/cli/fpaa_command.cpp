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

void add_plan_options(CommandLine& line) {
  line.positional("SECTIONS.json", 1, 1);
  line.output("folder for plan.json, build_sheet.md, build_sheet.html and board.svg");
  line.option<std::string>("board", "the board", "an231k04-quad4");
  line.option<double>("clock-hz", "clock of all filters (default: the best of the legal divider tree)");
  line.band("lower end of the band in which errors are minimised and stated", "its upper end");
  line.option<double>("max-error-percent", "exit with 1 when the complex error is above this");
  line.seed();
}

fpaa::PlanOptions plan_options(const CommandLine& line) {
  fpaa::PlanOptions out;
  out.board = line.get<std::string>("board");
  if (const auto clock = line.maybe_positive("clock-hz")) out.clock = Hertz{*clock};
  out.band = line.maybe_band();
  return out;
}

void write_plan(const std::filesystem::path& folder, const fpaa::Plan& plan, const Json& json) {
  OutputSet out(folder);
  out.add("plan.json", to_text(json));
  out.add("build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("build_sheet.html", fpaa::build_sheet_html(plan));
  out.add("board.svg", fpaa::board_picture_svg(plan));
  if (plan.chips.size() == 1) out.add("zrna.py", fpaa::zrna_script(plan));
  out.commit();
}

Json plan_summary(const fpaa::Plan& plan, const Json& json, const Provenance& from, bool limits_met) {
  const auto cams = plan.cams();
  Json out = json_header("fpaa_summary", from);
  out["board"] = plan.board;
  out["clock_hz"] = cams[0]->clock_a.value;
  out["cams"] = cams.size();
  out["chips"] = plan.chips.size();
  out["error"] = json["error"];
  out["error_with_delays"] = json["error_with_delays"];
  out["mismatch"] = json["budget"]["mismatch"];
  out["largest_input_v"] = plan.max_input_v;
  out["limits_met"] = limits_met;
  out["timing_s"] = json["timing_s"];
  return out;
}

std::string plan_text(const fpaa::Plan& plan, const fpaa::ErrorBudget& budget) {
  const auto cams = plan.cams();
  return fmt::format(
      "{} CAMs on {} chip{} of {}, clock {} Hz\n"
      "worst complex error {} to {} Hz: {} % ({} dB, {} deg) at {} Hz\n"
      "with the output hold: {} % ({} deg)\n"
      "0.1 % capacitor mismatch adds (95 %): {} %\n"
      "largest input: {} V\n",
      cams.size(), plan.chips.size(), plan.chips.size() == 1 ? "" : "s", plan.board,
      rounded_text(cams[0]->clock_a.value, 7), rounded_text(plan.error.band.from.value),
      rounded_text(plan.error.band.to.value), rounded_text(plan.error.max_complex_percent),
      rounded_text(plan.error.max_magnitude_db), rounded_text(plan.error.max_phase_deg),
      rounded_text(plan.error.worst.value), rounded_text(plan.error_with_delays.max_complex_percent),
      rounded_text(plan.error_with_delays.max_phase_deg), rounded_text(budget.mismatch.p95_percent, 3),
      rounded_text(plan.max_input_v));
}

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
  add_plan_options(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const Sections sections = Sections::read(file, from);
  const fpaa::PlanOptions options = plan_options(line);

  const Stopwatch watch;
  const auto outcome = fpaa::make_plan(sections, options);
  if (const Refusal* refusal = refusal_of(outcome)) {
    throw DesignError(fmt::format("{}: {}", file, refusal->reason));
  }
  const auto& plan = std::get<fpaa::Plan>(outcome);
  const double seconds = watch.seconds();

  const fpaa::ErrorBudget budget = fpaa::error_budget(plan, sections, {.seed = line.seed_value()});
  Json json = json_header("fpaa_plan", from);
  json.update(plan.to_json());
  json["budget"] = budget.to_json();
  json["timing_s"] = {{"compute", seconds}};
  write_plan(line.output_path(), plan, json);

  const auto limit = line.maybe<double>("max-error-percent");
  const bool met = !limit || plan.error.max_complex_percent <= *limit;
  std::string text = plan_text(plan, budget);
  if (!met) text += fmt::format("NOT met: the complex error is above {} %\n", *limit);
  text += fmt::format("written to {}\n", line.output_path().string());
  print_summary(line, text, plan_summary(plan, json, from, met));
  return met ? kDone : kLimitMissed;
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
