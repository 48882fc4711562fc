#include <fmt/format.h>

#include <numbers>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/shared_options.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "fpaa/streams/plan_stream.hpp"
#include "fpaa/streams/update_stream.hpp"
#include "fpaa/trim/trim.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith::cli {
namespace {

void declare_trim(CommandLine& line) {
  line.positional("PLAN.json", 1, 1);
  line.output("folder for the new plan.json, its build sheet, trim.json and the update streams");
  line.option<std::string>("measured", "CSV: frequency_hz, magnitude_db (or gain), phase_deg where measured");
  line.option<std::string>("sections", "target of the board (default: the plan with exact capacitors)");
  line.option<std::string>(
      "target",
      "plan.json whose response with exact capacitors is wanted, when the board was trimmed "
      "before: the plan as it was designed (default: PLAN.json itself)");
  line.option<double>("measurement-percent",
                      "standard deviation of a measured value (default: found from the measurement)");
  line.option<std::string>(
      "api", "ApiCode.c of the project on the board (default: it runs the streams of fpaa --stream)");
  line.option<std::string>(
      "unit-array",
      "how a capacitor's number chooses its units: nested (each holds the smaller ones) or "
      "binary (groups of 1, 2, 4 …: more of them change; not publicly known)",
      "binary");
  line.option<int>("samples",
                   "boards that agree with the measurement, on all of which the new ones are better", 400);
  line.band("lower end of the band in which the board is trimmed (default: the plan's)", "its upper end");
  line.seed();
  add_mismatch_options(line);
}

fpaa::MeasuredBoard read_measured(const CommandLine& line, Provenance& from) {
  if (!line.has("measured")) line.fail("--measured is missing, expected the built board's response (CSV)");
  const BodePoints points = BodePoints::read_csv(line.get<std::string>("measured"), from);
  if (points.points.empty()) {
    throw InputError(fmt::format("{}: there are no points, expected at least one", points.file));
  }
  fpaa::MeasuredBoard out;
  for (const BodePoint& p : points.points) {
    out.grid.push_back(p.frequency);
    out.gain.push_back(p.gain);
    if (p.phase_deg) out.phase_rad.push_back(*p.phase_deg * std::numbers::pi / 180.0);
  }
  if (!out.phase_rad.empty() && out.phase_rad.size() != out.grid.size()) {
    throw InputError(
        fmt::format("{}: phase_deg is there in some rows only, expected all or none", points.file));
  }
  if (const auto percent = line.maybe_positive("measurement-percent")) out.deviation = *percent / 100.0;
  return out;
}

std::vector<Complex> wanted_response(const CommandLine& line, const fpaa::Plan& plan,
                                     const std::vector<Hertz>& grid, Provenance& from) {
  if (line.has("sections") && line.has("target")) line.fail("--sections and --target, expected one of them");
  if (!line.has("sections")) {
    const fpaa::Plan target =
        line.has("target") ? fpaa::Plan::read(line.get<std::string>("target"), from) : plan;
    const fpaa::DrawnBoard board(target, grid);
    return board.response(board.nominal_units());
  }
  const Sections sections = Sections::read(line.get<std::string>("sections"), from);
  std::vector<Complex> out;
  for (const Hertz f : grid) out.push_back(sections.response(f.rad_s()));
  return out;
}

/// For a board that runs the primary stream of `fpaa --stream`: the capacitors that changed.
void add_updates_of_streams(const fpaa::Plan& before, const fpaa::Plan& after, OutputSet& out) {
  const auto old_streams = fpaa::an231::plan_streams(before);
  const auto new_streams = fpaa::an231::plan_streams(after);
  const auto* const was = std::get_if<fpaa::an231::PlanStreams>(&old_streams);
  const auto* const is = std::get_if<fpaa::an231::PlanStreams>(&new_streams);
  if (was == nullptr || is == nullptr) {
    note("no update stream: " + (was == nullptr ? refusal_of(old_streams) : refusal_of(new_streams))->reason);
    return;
  }
  std::string packets;
  for (std::size_t c = 0; c < is->chips.size(); ++c) {
    const auto changed = fpaa::changed_bytes(was->chips[c].memory, is->chips[c].memory);
    if (changed.empty()) continue;
    const fpaa::Bytes bytes = fpaa::encode(fpaa::update_of(is->chips[c].chip, changed));
    out.add(fmt::format("update_chip{}.ahf", is->chips[c].chip), fpaa::to_ahf(bytes));
    packets += fpaa::to_packet(bytes, false);
  }
  if (!packets.empty()) out.add("packets.bin", packets);
}

/// Capacitors only: the clocks stay as they are.
void add_updates(const CommandLine& line, const fpaa::Plan& before, const fpaa::Plan& plan, Provenance& from,
                 OutputSet& out) {
  if (!line.has("api")) return add_updates_of_streams(before, plan, out);
  const std::string path = line.get<std::string>("api");
  const fpaa::ApiProject project = fpaa::parse_api_code(from.read(path), path);
  const fpaa::UpdateOptions options{.names = {}, .clocks = false};
  std::string packets;
  for (const fpaa::ChipPlan& chip : plan.chips) {
    const fpaa::Bytes bytes = fpaa::encode(fpaa::update_stream(chip, project, options));
    out.add(fmt::format("update_chip{}.ahf", chip.chip), fpaa::to_ahf(bytes));
    packets += fpaa::to_packet(bytes, false);
  }
  out.add("packets.bin", packets);
}

std::string trim_text(const fpaa::Trim& trim) {
  const auto percent = [](double value) { return rounded_text(value, 3); };
  std::string text = fmt::format("error of this board as it was measured: {} % (95 %: below {} %)\n",
                                 percent(trim.before.median_percent), percent(trim.before.p95_percent));
  if (!trim.improved) {
    return text +
           "the old capacitors are kept: no others are better on every board that agrees with the "
           "measurement\n";
  }
  text += fmt::format("expected after the trim: {} % (95 %: below {} %), {} capacitor{} changed:",
                      percent(trim.after.median_percent), percent(trim.after.p95_percent),
                      trim.changes.size(), trim.changes.size() == 1 ? "" : "s");
  for (const fpaa::TrimmedCapacitor& c : trim.changes) {
    text += fmt::format(" {} {}->{}", c.name, c.before, c.after);
  }
  return text + "\n";
}

}  // namespace

int run_fpaa_trim(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa trim", "bodesmith fpaa trim out/fpaa/plan.json --measured bode.csv -o out/trimmed",
      "From the response measured on the built board: capacitors (and an update stream) that bring "
      "it to\nthe sections, with the error before and after. The old capacitors are kept where "
      "better is not certain.");
  declare_trim(line);
  line.reads_measurements();
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const fpaa::Plan plan = fpaa::Plan::read(file, from);
  fpaa::TrimOptions options;
  options.mismatch = read_mismatch(line, plan.mismatch);
  options.seed = line.seed_value();
  options.samples = line.integer("samples", 20, 100000);
  options.band = line.maybe_band();
  options.array = line.choice("unit-array", {fpaa::UnitArray::binary, fpaa::UnitArray::nested});
  const fpaa::MeasuredBoard measured = read_measured(line, from);
  const std::vector<Hertz> grid = fpaa::trim_grid(plan, options);
  const auto wanted = wanted_response(line, plan, grid, from);

  const Stopwatch watch;
  const fpaa::Trim trim = fpaa::trim_board(plan, wanted, grid, measured, options);
  const double seconds = watch.seconds();
  OutputSet out(line.output_path());
  Json json = json_header("fpaa_plan", from);
  json.update(trim.plan.to_json());
  out.add("plan.json", to_text(json));
  out.add("build_sheet.md", fpaa::build_sheet_markdown(trim.plan));
  Json summary = trim.to_json();
  summary["mismatch"] = options.mismatch.to_json();
  summary = timed_document("fpaa_trim", from, summary, seconds);
  out.add("trim.json", to_text(summary));
  add_updates(line, plan, trim.plan, from, out);
  out.commit();
  return print_summary(line, trim_text(trim) + fmt::format("written to {}\n", line.output_path().string()),
                       summary);
}

}  // namespace bodesmith::cli
