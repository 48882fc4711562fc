#include <fmt/format.h>

#include <memory>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "cli/response_source.hpp"
#include "cli/shared_options.hpp"
#include "faults/circuit_board.hpp"
#include "faults/plan_board.hpp"
#include "faults/report.hpp"
#include "fpaa/plan/plan.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::cli {
namespace {

void declare_board(CommandLine& line) {
  line.output("folder for faults.json and report.html");
  line.option<std::string>(
      "circuit",
      "circuit.json or compensator.sub of `bodesmith spice`: the board as it was meant to be built");
  line.option<std::string>("plan", "plan.json of `bodesmith fpaa`, for an FPAA board");
  line.option<std::string>("data",
                           "measured from input to output: frequency_hz, magnitude_db (or gain), phase_deg "
                           "where measured");
  line.repeatable("node", "NODE=FILE.csv: the same measured from the input to a node; may be repeated");
  const faults::Spread spread;
  line.group("What is known of the parts and of the measurement");
  add_tolerance_options(line, spread);
  line.option<double>("opamp-percent",
                      "standard deviation of the op-amps' gain-bandwidth and output resistance",
                      spread.opamp_percent);
  line.option<double>("stray-f", "standard deviation of the stray capacitance at every node", spread.stray_f);
  add_mismatch_options(line);
  line.option<double>("noise-db",
                      "standard deviation of a measured magnitude (default: from the measurement)");
  line.option<double>("noise-deg", "standard deviation of a measured phase (default: from the measurement)");
  line.reads_measurements();
}

faults::Spread read_part_spread(const CommandLine& line, faults::Spread out) {
  static_cast<schematic::Tolerances&>(out) = read_tolerances(line, out);
  out.opamp_percent = line.positive("opamp-percent");
  out.stray_f = line.positive("stray-f");
  out.mismatch = read_mismatch(line, out.mismatch);
  for (const double percent : {out.resistor_percent, out.capacitor_percent}) {
    if (!(percent > 0.0) || percent > 50.0) line.fail("a tolerance is not above 0 and at most 50 %");
  }
  return out;
}

faults::Measurement read_channels(const CommandLine& line, Provenance& from) {
  if (!line.has("data")) line.fail("--data is missing, expected the board's measured response (CSV)");
  faults::Measurement out;
  out.channels.push_back(faults::read_channel(line.get<std::string>("data"), "out", from));
  for (const std::string& given : line.all<std::string>("node")) {
    const std::size_t at = given.find('=');
    if (at == std::string::npos || at == 0) line.fail("--node " + given + ", expected NODE=FILE.csv");
    out.channels.push_back(faults::read_channel(given.substr(at + 1), given.substr(0, at), from));
  }
  return out;
}

/// A circuit.json, or a netlist of such elements, whose parts nobody said anything of.
schematic::Netlist read_circuit(const std::string& file, Provenance& from) {
  if (is_own_document(file)) return synthesis::CircuitFile::from_node(read_document(file, from)).circuit;
  schematic::Netlist out = read_netlist(file, from);
  out.tolerances = faults::Spread();
  return out;
}

/// `spread`: of the circuit's own tolerances, and what is asked for.
std::unique_ptr<faults::Board> read_board(const CommandLine& line, faults::Spread& spread, Provenance& from) {
  if (line.has("circuit") == line.has("plan")) line.fail("expected either --circuit or --plan");
  if (line.has("plan")) {
    const fpaa::Plan plan = fpaa::Plan::read(line.get<std::string>("plan"), from);
    spread.mismatch = plan.mismatch;
    spread = read_part_spread(line, spread);
    return std::make_unique<faults::PlanBoard>(plan, read_channels(line, from), spread);
  }
  const schematic::Netlist circuit = read_circuit(line.get<std::string>("circuit"), from);
  spread = read_part_spread(line, faults::Spread(circuit.tolerances));
  return std::make_unique<faults::CircuitBoard>(circuit, read_channels(line, from), spread);
}

}  // namespace

int run_diagnose_board(const std::vector<std::string>& arguments) {
  CommandLine line(
      "diagnose", "bodesmith diagnose --circuit out/spice/circuit.json --data measured.csv -o out/faults",
      "Names the part of a built board that is wrong, from its measured frequency response: a value that "
      "is off,\nswapped parts, an open, a short, a slow op-amp, a load, a missing ground, a capacitor or "
      "clock of an FPAA.");
  declare_board(line);
  if (!line.parse(arguments)) return kDone;
  faults::Spread spread;
  Provenance from;
  const std::unique_ptr<faults::Board> board = read_board(line, spread, from);
  faults::DiagnosisOptions options;
  if (const auto db = line.maybe_positive("noise-db")) options.gain_noise = *db / kDecibelPerNeper;
  if (const auto deg = line.maybe_positive("noise-deg")) options.phase_noise = to_radians(*deg);
  Progress progress("looking for the part that is wrong");
  options.progress = [&progress](double fraction) { progress.at(fraction); };
  options.stop = [] { return interrupted(); };
  const Stopwatch watch;
  const faults::Diagnosis diagnosis = faults::diagnose_board(*board, options);
  Json json = timed_document("faults", from, faults::to_json(diagnosis, *board, spread, options.priors),
                             watch.seconds());
  const std::filesystem::path folder = line.output_path();
  OutputSet files(folder);
  files.add("faults.json", to_text(json));
  files.add("report.html", faults::report_page(diagnosis, *board,
                                               line.get<std::string>(line.has("plan") ? "plan" : "circuit")));
  files.commit();
  return print_summary(
      line, faults::summary_text(diagnosis) + fmt::format("wrote {}\n", (folder / "faults.json").string()),
      json);
}

}  // namespace bodesmith::cli
