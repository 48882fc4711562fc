#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/network/switched_netlist.hpp"
#include "lti/frequency_grid.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::cli {
namespace {

void declare_sc(CommandLine& line) {
  line.positional("NETLIST", 1, 1);
  line.flag("ac", "the response: the output's component at the input's own frequency (the default)");
  line.flag(
      "noise",
      "density of the noise at the output, every folding in it: kT/C of the switches, and what op-amps have by noise=V/rtHz gbw=HZ");
  line.option<double>("temperature-k", "of the switches", 300.0);
  line.band("lowest frequency (default: a thousandth of the slowest clock)",
            "highest (default: half the fastest clock)");
  line.option<int>("count", "frequencies, evenly spaced in logarithm", 200);
  line.output("CSV: frequency_hz, magnitude_db, phase_deg, noise_v_per_rthz");
}

/// Time constants in a phase: of fewer a step is left more than .7 % short, and noise is up to .3 dB off.
constexpr double kSettled = 5.0;

Band sc_band(const CommandLine& line, const fpaa::SwitchedNetlist& netlist) {
  Band band{{INFINITY}, {0.0}};
  for (const Hertz f : netlist.clocks) {
    band.from.value = std::min(band.from.value, 1e-3 * f.value);
    band.to.value = std::max(band.to.value, 0.5 * f.value);
  }
  if (line.has("from-hz")) band.from = {line.positive("from-hz")};
  if (line.has("to-hz")) band.to = {line.positive("to-hz")};
  if (!(band.to > band.from)) line.fail("the band is empty, expected --from-hz below --to-hz");
  return band;
}

}  // namespace

/// `bodesmith sc`: response and noise of a switched-capacitor netlist, exactly.
int run_sc(const std::vector<std::string>& arguments) {
  CommandLine line(
      "sc", "bodesmith sc filter.sc --ac --noise --from-hz 10 --to-hz 100e3 -o filter.csv",
      "Reads a small netlist of capacitors, clocked switches and op-amps (.clock main 100k; V1 in "
      "0; C1 a b 1p; S1 a b main.1; O1 plus minus out noise=5n gbw=10meg; .output out) and writes what it does to a "
      "sine and its noise, by charge conservation in the exact periodic steady state.");
  declare_sc(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const auto netlist = fpaa::SwitchedNetlist::read(from.read(file), file);
  const Band band = sc_band(line, netlist);
  const bool noise = line.has("noise");
  const bool ac = line.has("ac") || !noise;
  const Stopwatch watch;
  const double temperature_k = line.positive("temperature-k");
  const fpaa::PeriodicNetworks networks =
      netlist.networks(noise ? std::optional(temperature_k) : std::nullopt);
  if (const double settled = networks.settled(); settled < kSettled)
    note(fmt::format(
        "an op-amp has {} time constants in the shortest phase: response and noise are those of settled ones",
        rounded_text(settled, 2)));
  std::vector<std::string> names{std::string(column::frequency_hz)};
  if (ac) names.insert(names.end(), {std::string(column::magnitude_db), std::string(column::phase_deg)});
  if (noise) names.emplace_back("noise_v_per_rthz");
  CsvTable table(names);
  double square = 0.0;
  double last_density = 0.0;
  double last_hz = 0.0;
  for (const Hertz f : log_grid(band, line.integer("count", 2, 10'000'000))) {
    std::vector<std::string> cells{number_text(f.value)};
    if (ac) {
      const Complex h = networks.gain(f.rad_s());
      cells.push_back(number_text(to_decibel(std::abs(h))));
      cells.push_back(number_text(to_degrees(std::arg(h))));
    }
    if (noise) {
      const double density = netlist.thermal_v2(temperature_k) * networks.noise_density(f.rad_s())[0];
      cells.push_back(number_text(std::sqrt(density)));
      if (last_hz > 0.0) square += 0.5 * (density + last_density) * (f.value - last_hz);
      last_density = density;
      last_hz = f.value;
    }
    table.add_row(cells);
  }
  const double seconds = watch.seconds();
  OutputSet out;
  out.add(line.output_path(), table.text());
  out.commit();
  Json json = json_header("sc_summary", from);
  json["band_hz"] = {band.from.value, band.to.value};
  if (noise) json["noise_v"] = std::sqrt(square);
  json["timing_s"] = {{"compute", seconds}};
  // A follower of the output is the reader's own, without a name.
  const auto opamps = std::ranges::count_if(netlist.circuit.netlist.opamps,
                                            [](const schematic::OpAmp& one) { return !one.name.empty(); });
  std::string text =
      fmt::format("{} capacitors, {} switches, {} op-amps\n", netlist.circuit.netlist.parts.size(),
                  netlist.circuit.netlist.contacts.size(), opamps);
  if (noise)
    text += fmt::format("noise from {} to {} Hz: {}\n", rounded_text(band.from.value),
                        rounded_text(band.to.value), engineering_text(std::sqrt(square), "V rms"));
  return print_summary(line, text + fmt::format("written to {}\n", line.output_path().string()), json);
}

}  // namespace bodesmith::cli
