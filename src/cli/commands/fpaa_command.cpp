#include <fmt/format.h>

#include <optional>
#include <string>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/shared_options.hpp"
#include "fpaa/plan/error_budget.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/sheets/board_netlist.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "fpaa/streams/stream_output.hpp"
#include "lti/sections.hpp"
#include "project/report/report_chapters.hpp"

namespace bodesmith::cli {
namespace {

struct StreamArtefacts {
  OutputSet files;   ///< of the folder stream/
  Json json;         ///< of plan.json
  std::string text;  ///< of the summary: how to power on for the first time
};

/// chip1.out1=IO3.
fpaa::an231::PinCells chosen_cells(const CommandLine& line) {
  fpaa::an231::PinCells out;
  for (const std::string& text : line.all<std::string>("pin")) {
    const std::size_t cut = text.find("=IO");
    const std::string cell = cut == std::string::npos ? "" : text.substr(cut + 3);
    if (cut == 0 || cell.size() != 1 || cell[0] < '1' || cell[0] > '7') {
      line.fail(fmt::format("--pin '{}', expected for instance chip1.out1=IO3 (IO1 to IO7)", text));
    }
    out[text.substr(0, cut)] = cell[0] - '0';
  }
  return out;
}

/// --stream and --pin.
void add_stream_options(CommandLine& line) {
  line.flag("stream",
            "also complete configuration streams of the chips, without any vendor program: stream/chipN.ahf, "
            "primary.c, packets.bin, and how to power on for the first time");
  line.repeatable("pin", "with --stream: I/O cell of a pin, e.g. chip1.out1=IO3");
}

/// Nothing without --stream. The plan learns which I/O cell is which pin. Throws DesignError when no stream can
/// be made of it.
std::optional<StreamArtefacts> make_streams(fpaa::Plan& plan, const CommandLine& line) {
  const fpaa::an231::PinCells cells = chosen_cells(line);
  if (!line.has("stream")) {
    if (!cells.empty()) line.fail("--pin without --stream, expected both");
    return std::nullopt;
  }
  const auto streams = value_or_throw(fpaa::an231::plan_streams(plan, cells));
  const double difference = fpaa::an231::check_streams(plan, streams);
  for (fpaa::ChipPlan& chip : plan.chips) chip.pins = streams.pins_of(chip.chip);
  return StreamArtefacts{fpaa::an231::stream_files(plan, streams, "plan.json"),
                         fpaa::an231::stream_json(streams, difference),
                         fpaa::an231::first_power_on(plan, streams) + "\n"};
}

void add_plan_options(CommandLine& line) {
  line.positional("SECTIONS.json...", 1, -1);
  line.output("folder for plan.json, build_sheet.md, build_sheet.html and board.svg (trade_off.svg)");
  line.option<std::string>("board", "the board", "an231k04-quad4");
  line.words("board", {"an231k04-quad4"});
  line.option<std::string>(
      "topology",
      "auto, chain (CAMs that AnadigmDesigner2 has, alone), bilinear (FilterBilinear, one chip, one clock)",
      "auto");
  line.words("topology", {"auto", "chain", "bilinear"});
  line.option<double>("clock-hz", "one clock for all: a chain (default: clocks are searched)");
  line.option<double>("min-clock-hz", "no clock below this; slow poles by two capacitor ratios");
  line.band("lower end of the band in which errors are minimised and stated", "its upper end");
  line.option<double>("max-error-percent", "exit with 1 when the complex error as it runs is above this");
  add_mismatch_options(line);
  add_noise_options(line);
  add_slow_options(line);
  add_stream_options(line);
  line.flag("spice", "also the plan as switched capacitors: board.sub, and board.cir for ngspice");
  line.seed();
}

fpaa::PlanOptions plan_options(const CommandLine& line) {
  fpaa::PlanOptions out;
  out.board = line.get<std::string>("board");
  if (const auto clock = line.maybe_positive("clock-hz")) out.clock = Hertz{*clock};
  using Topology = fpaa::PlanOptions::Topology;
  out.topology = line.choice("topology", {Topology::automatic, Topology::chain, Topology::bilinear});
  if (const auto clock = line.maybe_positive("min-clock-hz")) out.lowest_clock = Hertz{*clock};
  out.band = line.maybe_band();
  out.assumptions = {read_mismatch(line, {}), read_noise_model(line), read_slow_parts(line),
                     line.seed_value()};
  return out;
}

std::optional<fpaa::NetlistParts> netlist_parts(const CommandLine& line) {
  if (!line.has("spice")) return std::nullopt;
  return fpaa::NetlistParts{.unit_capacitance_f = read_noise_model(line).unit_capacitance_f};
}

/// Where not all that is wanted was found: what the search had to choose between.
std::string trade_off_text(const fpaa::Plan& plan) {
  if (plan.trade_off.empty()) return "";
  std::vector<std::string> points;
  for (const fpaa::TradeOff& at : plan.trade_off) {
    points.push_back(fmt::format("{} {} % ({} designed{})", engineering_text(at.at_input_v, "V", 3),
                                 rounded_text(at.p95_percent, 2), rounded_text(at.designed_percent, 2),
                                 at.chosen ? ", taken" : ""));
  }
  return fmt::format(
      "error of 95 % of boards against input, of designs that no other one beats in both and by design: {}\n",
      join(points, ", "));
}

void write_plan(const std::filesystem::path& folder, const fpaa::Plan& plan, const Json& json,
                const OutputSet* streams, const std::optional<fpaa::NetlistParts>& netlist) {
  OutputSet out(folder);
  if (streams != nullptr) out.include("stream", *streams);
  out.add("plan.json", to_text(json));
  out.add("build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("build_sheet.html", fpaa::build_sheet_html(plan));
  out.add("board.svg", fpaa::board_picture_svg(plan));
  if (!plan.trade_off.empty()) out.add("trade_off.svg", report::to_svg(project::trade_off_plot(plan)));
  if (const auto script = fpaa::zrna_script(plan)) out.add("zrna.py", *script);
  if (netlist) {
    out.add("board.sub", fpaa::board_netlist(plan, *netlist, "FPAA plan"));
    out.add("board.cir", fpaa::board_deck(plan, "FPAA plan"));
  }
  out.commit();
}

std::string clocks_text(const fpaa::Plan& plan) {
  std::vector<std::string> out;
  for (const double clock : plan.clocks_hz()) out.push_back(engineering_text(clock, "Hz", 6));
  return join(out, ", ");
}

Json plan_summary(const fpaa::Plan& plan, const Json& json, const Provenance& from, bool limits_met) {
  const auto cams = plan.cams();
  Json out = json_header("fpaa_summary", from);
  out["board"] = plan.board;
  out["clock_hz"] = cams.back()->clock_a.value;
  out["topology"] = plan.topology;
  out["cams"] = cams.size();
  out["opamps"] = plan.opamps();
  out["clocks_hz"] = plan.clocks_hz();
  out["chips"] = plan.chips.size();
  out["error"] = json["error"];
  out["error_with_delays"] = json["error_with_delays"];
  out["mismatch"] = json["mismatch"];
  out["largest_input_v"] = plan.max_input_v;
  for (const char* key : {"largest_image", "largest_image_in_band"}) {
    if (json.contains(key)) out[key] = json[key];
  }
  if (json.contains("trade_off")) out["trade_off"] = json["trade_off"];
  if (json.contains("total")) out["total"] = json["total"];
  out["limits_met"] = limits_met;
  out["timing_s"] = json["timing_s"];
  return out;
}

std::string total_text(const fpaa::Plan& plan) {
  if (!plan.total) return "";
  const fpaa::PlanTotal& total = *plan.total;
  return fmt::format(
      "95 % of boards, of a sine of {}, are off what was asked for by at most {} % ({} by design, {} noise)\n"
      "mismatch of {} % a unit capacitor moves 95 % of boards off the design by at most {} %\n",
      engineering_text(total.at_input_v, "V"), rounded_text(total.p95_percent, 3),
      rounded_text(total.designed_percent, 3), rounded_text(total.noise_percent, 3),
      rounded_text(plan.mismatch.unit_percent), rounded_text(total.mismatch_p95_percent, 3));
}

/// Why nobody would build this board; nothing: somebody might. A tenth is nearly a decibel: beyond it neither curve
/// nor signal is what was asked for.
std::optional<std::string> unusable(const fpaa::Plan& plan) {
  constexpr double kUselessPercent = 10.0;
  if (!plan.total) return std::nullopt;
  const fpaa::PlanTotal& total = *plan.total;
  if (total.designed_percent > kUselessPercent)
    return fmt::format("this board is {} % off what was asked for, as designed",
                       rounded_text(total.designed_percent, 3));
  if (total.noise_percent > kUselessPercent)
    return fmt::format("this board takes an input of {} at most, and its noise is {} % of that at the output",
                       engineering_text(total.at_input_v, "V"), rounded_text(total.noise_percent, 3));
  if (total.image_percent > 100.0 * fpaa::kUselessShare)
    return fmt::format(
        "lines of this board's clocks within the band come to {} % of a sine, of no use above {} %; expected a narrower band "
        "(--from-hz, --to-hz), or sections without zeros far below their poles",
        rounded_text(total.image_percent, 2), 100.0 * fpaa::kUselessShare);
  return std::nullopt;
}

std::string plan_text(const fpaa::Plan& plan, const fpaa::ErrorBudget& budget) {
  const auto cams = plan.cams();
  const fpaa::PlanError& runs = plan.error_with_delays;
  std::string out = fmt::format(
      "{}: {} CAMs, {} op-amps on {} chip{} of {}, clocks {}\n"
      "as it runs, {} to {}: {} % ({} dB, {} deg) at {} worst; every switch of every clock in it\n"
      "{}{}"
      "kT/C noise in the band: {} uV with units of {} fF\n"
      "largest input: {} V\n",
      plan.topology, cams.size(), plan.opamps(), plan.chips.size(), plan.chips.size() == 1 ? "" : "s",
      plan.board, clocks_text(plan), engineering_text(runs.band.from.value, "Hz", 4),
      engineering_text(runs.band.to.value, "Hz", 4), rounded_text(runs.max_complex_percent),
      rounded_text(runs.max_magnitude_db), rounded_text(runs.max_phase_deg),
      engineering_text(runs.worst.value, "Hz", 4), late_text(plan, budget.late), total_text(plan),
      rounded_text(budget.assumptions.noise.microvolts(budget.noise_in_band_kt_per_cu), 3),
      rounded_text(1e15 * budget.assumptions.noise.unit_capacitance_f), rounded_text(plan.max_input_v));
  const auto add_image = [&](const char* what, const std::optional<fpaa::ImageLine>& image) {
    if (!image) return;
    out += fmt::format("{}: {} dB, at {} for a sine of {}\n", what, rounded_text(image->magnitude_db, 3),
                       engineering_text(image->line.value, "Hz", 4),
                       engineering_text(image->signal.value, "Hz", 4));
  };
  add_image("largest image below 100 kHz", plan.image);
  add_image("largest image within the band", plan.image_in_band);
  if (plan.image_in_band && plan.total)
    out += fmt::format("all images within the band: {} % rms for a sine of the band\n",
                       rounded_text(plan.total->image_percent, 2));
  out += trade_off_text(plan);
  return out;
}

int plan_board(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa", "bodesmith fpaa sections.json -o out/fpaa",
      "Turns sections into the CAMs of an FPAA board: clocks, capacitors, places, wires; writes plan.json\n"
      "and a build sheet to type from.\n\n"
      "With a finished plan (each has its own --help):\n"
      "  bodesmith fpaa streams PLAN.json --api ApiCode.c -o DIR   update streams for the board\n"
      "  bodesmith fpaa verify PLAN.json STREAM… --api ApiCode.c   decodes streams, compares with the plan\n"
      "  bodesmith fpaa check PLAN.json REPORT.htm                 compares AnadigmDesigner2's report\n"
      "  bodesmith fpaa controller DISTURBANCE.json -o DIR         the whole controller on the board\n"
      "  bodesmith fpaa gains DISTURBANCE.json --api ApiCode.c -o DIR   branch gains that a host sends\n"
      "  bodesmith fpaa disassemble STREAM… -o netlist.json        any AN231 stream back to a netlist\n"
      "  bodesmith fpaa trim PLAN.json --measured bode.csv -o DIR  new capacitors from the built board's response\n"
      "  bodesmith fpaa send PACKETS.bin --port DEVICE             sends packets to the board");
  add_plan_options(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = join(line.files(), ", ");
  const Sections sections = read_rational_series(line.files(), from);
  if (integrates(sections)) {
    throw DesignError(
        file, 0,
        "has a pole at 0, which a plan does not make (an integrator drifts to its rail without a loop): "
        "expected the lowest pole above 0, as approximate without --keep-integrator leaves it");
  }
  const fpaa::PlanOptions options = plan_options(line);

  const Stopwatch watch;
  const auto outcome = fpaa::make_plan(sections, options);
  if (const Refusal* refusal = refusal_of(outcome)) {
    throw DesignError(fmt::format("{}: {}", file, refusal->reason));
  }
  auto plan = std::get<fpaa::Plan>(outcome);
  const std::optional<StreamArtefacts> stream = make_streams(plan, line);
  const double seconds = watch.seconds();

  const fpaa::ErrorBudget budget = fpaa::error_budget(plan, sections, options.assumptions);
  Json json = plan.to_json();
  json["budget"] = budget.to_json();
  json = timed_document("fpaa_plan", from, json, seconds);
  if (stream) json["stream"] = stream->json;
  const auto limit = line.maybe<double>("max-error-percent");
  write_plan(line.output_path(), plan, json, stream ? &stream->files : nullptr, netlist_parts(line));

  const std::optional<std::string> useless = unusable(plan);
  // A limit that was given is the user's own judgement.
  const bool met = limit ? plan.error_with_delays.max_complex_percent <= *limit : !useless;
  std::string text = plan_text(plan, budget);
  if (useless) {
    note("warning: " + *useless);
    text += fmt::format("NOT usable: {}\n", *useless);
  }
  if (limit && !met) text += fmt::format("NOT met: the complex error as it runs is above {} %\n", *limit);
  Json summary = plan_summary(plan, json, from, met);
  if (stream) {
    text += "\n" + stream->text;
    summary["stream"] = stream->json;
  }
  text += fmt::format("written to {}\n", line.output_path().string());
  return print_summary(line, text, summary, met);
}

}  // namespace

int run_fpaa_streams(const std::vector<std::string>& arguments);
int run_fpaa_verify(const std::vector<std::string>& arguments);
int run_fpaa_check(const std::vector<std::string>& arguments);
int run_fpaa_trim(const std::vector<std::string>& arguments);
int run_fpaa_send(const std::vector<std::string>& arguments);
int run_fpaa_controller(const std::vector<std::string>& arguments);
int run_fpaa_disassemble(const std::vector<std::string>& arguments);
int run_fpaa_gains(const std::vector<std::string>& arguments);

const std::vector<Command>& fpaa_verbs() {
  static const std::vector<Command> all = {
      {"streams", "update streams for the board", run_fpaa_streams},
      {"verify", "decodes streams, compares with the plan", run_fpaa_verify},
      {"check", "compares AnadigmDesigner2's report", run_fpaa_check},
      {"controller", "the whole controller on the board", run_fpaa_controller},
      {"gains", "branch gains that a host sends", run_fpaa_gains},
      {"disassemble", "any AN231 stream back to a netlist", run_fpaa_disassemble},
      {"trim", "new capacitors from the built board's response", run_fpaa_trim},
      {"send", "sends packets to the board", run_fpaa_send}};
  return all;
}

int run_fpaa(const std::vector<std::string>& arguments) {
  if (const Command* verb = find_command(fpaa_verbs(), arguments))
    return verb->run({arguments.begin() + 1, arguments.end()});
  return plan_board(arguments);
}

}  // namespace bodesmith::cli
