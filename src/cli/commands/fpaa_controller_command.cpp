#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/controller/branches.hpp"
#include "fpaa/controller/controller.hpp"
#include "fpaa/controller/gains.hpp"
#include "fpaa/controller/io.hpp"
#include "fpaa/controller/netlist.hpp"
#include "fpaa/controller/scale.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/streams/stream_output.hpp"
#include "project/tracking/board_controller.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::cli {
namespace {

/// Of a reference that the board is run with: a slower one would take too long, a faster one leaves no samples.
constexpr double kSlowestHz = 0.1;
constexpr double kFastestHz = 20e3;

void add_controller_options(CommandLine& line) {
  line.positional("DISTURBANCE.json", 1, 1);
  line.output("folder for controller.json, controller.md and the look-up tables");
  line.option<std::string>("ascending", "plan.json of the ascending branch's compensator");
  line.option<std::string>("descending", "plan.json of the descending branch's compensator");
  line.option<std::string>("polynomial",
                           "outside, multipliers or lookup (default: the one that tracks best)");
  line.option<std::string>("structure",
                           "loop, two-pass, delayed or open (default: the one that tracks best)");
  line.flag("outside-switch",
            "the branch by an analogue switch next to the board, driven by the reference generator: then the "
            "look-up variant has complete streams too");
  line.list<double>("track-hz", "frequencies of the full-stroke triangle (default: 1 10 20 40 60 80 100)");
  line.option<double>(
      "fast-clock-hz",
      "clock of everything but the compensators (default: 250 kHz; 1 MHz where only that tracks within 0.05 %)");
  line.option<double>("outside-error-percent", "error of each AD835, of its full scale", 0.1);
}

fpaa::ControllerOptions controller_options(const CommandLine& line) {
  fpaa::ControllerOptions out;
  if (const auto clock = line.maybe_positive("fast-clock-hz")) out.fast_clock = {*clock};
  out.outside_error_percent = line.positive("outside-error-percent");
  out.outside_switch = line.has("outside-switch");
  if (line.has("polynomial")) {
    using By = fpaa::PolynomialBy;
    out.polynomial = line.choice("polynomial", {By::outside, By::multipliers, By::lookup});
  }
  if (line.has("structure")) {
    using Structure = fpaa::ControllerStructure;
    out.structure =
        line.choice("structure", {Structure::loop, Structure::two_pass, Structure::delayed, Structure::open});
  }
  return out;
}

std::optional<fpaa::Plan> read_compensator(const CommandLine& line, const char* option, Provenance& from) {
  if (!line.has(option)) return std::nullopt;
  return fpaa::Plan::read(line.get<std::string>(option), from);
}

std::vector<Hertz> frequencies_to_track(const CommandLine& line) {
  std::vector<double> given = {1, 10, 20, 40, 60, 80, 100};
  if (line.has("track-hz")) given = line.get<std::vector<double>>("track-hz");
  std::vector<Hertz> out;
  for (const double f : given) {
    if (!std::isfinite(f) || !(f >= kSlowestHz) || !(f <= kFastestHz)) {
      line.fail(fmt::format("--track-hz {} is out of range, expected {} to {} Hz", number_text(f),
                            number_text(kSlowestHz), number_text(kFastestHz)));
    }
    out.push_back({f});
  }
  std::ranges::sort(out);
  return out;
}

/// The tables of a variant, as the CAM's dialog loads them.
void add_tables(OutputSet& out, const fpaa::ControllerVariant& variant, const Disturbance& disturbance,
                const fpaa::DriveRange& range) {
  using Branch = Disturbance::Branch;
  for (const auto& [branch, name] :
       {std::pair{Branch::ascending, "Ascending"}, std::pair{Branch::descending, "Descending"}}) {
    const fpaa::ControllerCam* cam = variant.find(std::string(name) + "Table");
    if (cam == nullptr) continue;
    const fpaa::TableShape shape = fpaa::table_shape(disturbance, branch, range, variant.scale);
    const auto wanted = [&, b = branch](double v) {
      return fpaa::table_volts(disturbance, b, shape, variant.scale, v);
    };
    out.add(branch == Branch::ascending ? "lookup_ascending.csv" : "lookup_descending.csv",
            fpaa::LookupTable::from(cam->requested).csv(wanted));
  }
}

void write_controller(const std::filesystem::path& folder, const fpaa::Controller& controller,
                      const Json& json, const project::BoardTracking& tracking,
                      const Disturbance& disturbance, const fpaa::DriveRange& range,
                      const Outcome<fpaa::ControllerStreams>& streams) {
  OutputSet out(folder);
  out.add("controller.json", to_text(json));
  out.add("controller.md", fpaa::controller_sheet(controller));
  out.add("tracking.csv", tracking.csv());
  const fpaa::Plan plan = fpaa::controller_plan(controller.best());
  const std::string sets = fpaa::gain_sets_csv(controller.best(), disturbance);
  if (!sets.empty()) out.add("gain_sets.csv", sets);
  if (const auto* made = std::get_if<fpaa::ControllerStreams>(&streams)) out.include("stream", made->files);
  if (controller.best().by == fpaa::PolynomialBy::outside) {
    const Hertz served = tracking.frequency.back();
    out.add("board_controller.sub",
            fpaa::controller_netlist(controller.best().at(disturbance, served), {},
                                     fmt::format("FPAA controller ({}), gains for {} Hz",
                                                 controller.best().name(), rounded_text(served.value))));
  }
  out.add("board.svg", fpaa::board_picture_svg(plan, fpaa::pin_signals(controller.best())));
  const fpaa::ControllerVariant* tables = &controller.best();
  for (const fpaa::ControllerVariant& v : controller.variants) {
    const bool lookup = v.by == fpaa::PolynomialBy::lookup && v.fits();
    if (lookup && tables->by != fpaa::PolynomialBy::lookup) tables = &v;
  }
  add_tables(out, *tables, disturbance, range);
  out.commit();
}

std::string controller_text(const fpaa::Controller& controller, const project::BoardTracking& tracking) {
  std::string out =
      fmt::format("{}\nrms tracking error, % of range, lag removed:\n  {:<44}", controller.why, "");
  for (const Hertz f : tracking.frequency) out += fmt::format("{:>9}", rounded_text(f.value) + " Hz");
  for (const project::BoardTrackingRow& row : tracking.rows) {
    out += fmt::format("\n  {:<44}", row.name);
    if (row.why_not) out += "  " + *row.why_not;
    for (const tracking::TrackingError& at : row.at)
      out += fmt::format("{:>9.3f}", at.rms_percent_without_lag);
    if (!row.clipped.empty()) out += "  clips: " + join(row.clipped, ", ");
  }
  const fpaa::ControllerVariant& v = controller.best();
  return out + fmt::format("\n{}: {} CAMs on {} chips, {} op-amps, {} capacitors, delay {} us\n", v.name(),
                           v.cams.size(), v.chips, v.resources.opamps, v.resources.capacitors,
                           rounded_text(1e6 * v.delay_s, 4));
}

Json stream_json(const Outcome<fpaa::ControllerStreams>& streams) {
  if (const Refusal* refusal = refusal_of(streams)) return {{"why_not", refusal->reason}};
  const auto& made = std::get<fpaa::ControllerStreams>(streams);
  Json out = {{"status", fpaa::an231::kStreamStatus}, {"warnings", made.warnings}, {"gain_sets", made.sets}};
  for (const auto& [pin, cell] : made.cells) out["pins"][pin] = fmt::format("IO{}", cell);
  return out;
}

std::string stream_text(const Outcome<fpaa::ControllerStreams>& streams) {
  if (const Refusal* refusal = refusal_of(streams)) return "no complete stream: " + refusal->reason + "\n";
  const auto& made = std::get<fpaa::ControllerStreams>(streams);
  return fmt::format("complete streams, and updates for {} gain sets ({})\n", made.sets,
                     fpaa::an231::kStreamStatus);
}

}  // namespace

int run_fpaa_controller(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa controller",
      "bodesmith fpaa controller disturbance.json --descending out/fpaa/plan.json -o out/controller",
      "Places the whole controller (both branches' polynomials, amplitude gains, compensators, branch "
      "switch)\n"
      "on the board; compares the ways to make the polynomials and says which it took and why.");
  add_controller_options(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const Disturbance disturbance = Disturbance::read(file, from);
  const auto ascending = read_compensator(line, "ascending", from);
  const auto descending = read_compensator(line, "descending", from);

  const Stopwatch watch;
  const fpaa::ControllerOptions options = controller_options(line);
  const std::vector<Hertz> frequencies = frequencies_to_track(line);
  const tracking::PolynomialStage stage(disturbance);
  const fpaa::BranchPlans compensators = {ascending ? &*ascending : nullptr,
                                          descending ? &*descending : nullptr};
  const auto outcome = project::track_controller(disturbance, compensators, options,
                                                 line.has("fast-clock-hz"), stage, frequencies);
  if (const Refusal* refusal = refusal_of(outcome))
    throw DesignError(fmt::format("{}: {}", file, refusal->reason));
  const auto& [controller, tracking] = std::get<project::TrackedController>(outcome);
  Json json = timed_document("fpaa_controller", from, controller.to_json(), watch.seconds());
  json["tracking"] = tracking.to_json();
  const auto streams = fpaa::controller_streams(controller.best(), disturbance);
  json["stream"] = stream_json(streams);
  write_controller(line.output_path(), controller, json, tracking, disturbance,
                   fpaa::drive_range(disturbance, compensators), streams);
  return print_summary(line,
                       controller_text(controller, tracking) + stream_text(streams) +
                           fmt::format("written to {}\n", line.output_path().string()),
                       json);
}

}  // namespace bodesmith::cli
