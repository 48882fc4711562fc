#include <fmt/format.h>

#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "circuit/json.hpp"
#include "circuit/opamp_check.hpp"
#include "circuit/opamp_library.hpp"
#include "circuit/parts/stock.hpp"
#include "circuit/realisation.hpp"
#include "cli/circuit_options.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/rational_part.hpp"
#include "kicad/schematic.hpp"
#include "spice/compensator_check.hpp"
#include "spice/emit.hpp"

namespace bodesmith::cli {
namespace {

void declare_spice(CommandLine& line) {
  line.positional("SECTIONS.json", 1, 1);
  line.output(
      "folder for compensator.sub, decks for ngspice, LTspice and Xyce, a KiCad project, parts.csv and "
      "circuit.json");
  add_circuit_options(line);
  line.option<std::string>(
      "stock",
      "a list of parts in stock instead of series: TOML (bodesmith.stock/1: values_ohm, values_f, "
      "limits) or CSV (resistance_ohm,capacitance_f, one value a row)");
  line.option<double>("min-ohm", "smallest resistor (ladders: 100)", 1e3);
  line.option<double>("max-ohm", "largest resistor (ladders: 1e7)", 2.2e6);
  line.option<double>("min-f", "smallest capacitor", 47e-12);
  line.option<double>("max-f", "largest capacitor (ladders: 4.7e-6)", 220e-9);
  line.option<double>(
      "isolation-ohm",
      "in series with the input capacitor of first-order stages, so that the op-amp before does not "
      "ring (default: a fifth of its output resistance where the band allows it; 0: none)");
  line.option<std::string>(
      "opamp", "type of op-amp; auto: the first one in the list that is good enough; ideal", "generic-10M");
  line.option<std::string>("opamp-library", "a TOML list of op-amps of your own");
  line.option<double>("amplitude-v", "largest input, for the checks of slew rate and swing", 1.0);
  line.option<double>(
      "max-error-db",
      "exit with 1 when the error of parts and op-amps together against the sections is larger");
  line.band("band of the search and of the errors (default: 1/10 of the lowest corner",
            "to 10 times the highest)");
  add_check_option(line, "run ngspice and compare with the program's own response");
}

circuit::OpAmpLibrary library_of(const CommandLine& line, Provenance& from) {
  if (const auto file = line.maybe<std::string>("opamp-library"))
    return circuit::OpAmpLibrary::read(*file, from);
  return circuit::OpAmpLibrary::built_in();
}

bool automatic_opamp(const CommandLine& line) {
  return line.get<std::string>("opamp") == "auto";
}

/// Limits of the values: the form's or the stock list's own, then those that were given.
void read_value_limits(const CommandLine& line, Provenance& from, circuit::RealiseOptions& options) {
  options.limits = circuit::realisation_registry().get(options.realisation).usual_limits();
  if (line.has("stock")) circuit::StockList::read(line.get<std::string>("stock"), from).apply_to(options);
  const auto limit = [&](const char* name, double& value) {
    const double given = line.positive(name);
    if (line.has(name)) value = given;
  };
  limit("min-ohm", options.limits.min_ohm);
  limit("max-ohm", options.limits.max_ohm);
  limit("min-f", options.limits.min_f);
  limit("max-f", options.limits.max_f);
  if (line.has("stock") && options.resistors.is_exact() != options.capacitors.is_exact()) {
    line.fail("--stock cannot be combined with exact parts, expected a series for what the list leaves out");
  }
}

circuit::RealiseOptions read_spice_options(const CommandLine& line, Provenance& from) {
  circuit::RealiseOptions options = read_circuit_options(line);
  read_value_limits(line, from, options);
  if (line.has("isolation-ohm")) {
    const double ohm = line.get<double>("isolation-ohm");
    if (!(ohm >= 0.0) || ohm > 1e6) line.fail("--isolation-ohm is out of range, expected 0 to 1e6");
    options.isolation_ohm = ohm;
  }
  if (!automatic_opamp(line)) options.opamp = library_of(line, from).named(line.get<std::string>("opamp"));
  options.band = line.maybe_band();
  return options;
}

std::string circuit_summary(const circuit::Realised& made, const circuit::RealiseOptions& options,
                            const circuit::OpAmpCheck& opamps) {
  const circuit::RealiseReport& report = made.report;
  return fmt::format(
             "{} stages, {} op-amps, {} parts ({} resistors, {} capacitors)\n"
             "parts against the sections, {} to {} Hz: {} dB, {} deg ({} dB with every value rounded on its own)\n"
             "op-amps ({}): {} dB; all together: {} dB, {} deg\n",
             made.circuit.stages.size(), made.circuit.opamps.size(), made.circuit.parts.size(),
             options.resistors.name(), options.capacitors.name(), rounded_text(report.band.from.value),
             rounded_text(report.band.to.value), rounded_text(report.parts.max_magnitude_db, 3),
             rounded_text(report.parts.max_phase_deg, 3), rounded_text(report.nearest.max_magnitude_db, 3),
             made.circuit.model.name, rounded_text(report.opamps.max_magnitude_db, 3),
             rounded_text(report.all.max_magnitude_db, 3), rounded_text(report.all.max_phase_deg, 3)) +
         fmt::format(
             "phase margin of every op-amp {} deg or more; offset at most {} V; noise {} V rms over the band\n",
             rounded_text(opamps.min_phase_margin_deg, 3), rounded_text(opamps.output_offset_v, 3),
             rounded_text(opamps.noise_rms_v, 3));
}

std::string check_text(const spice::CompensatorCheck& check) {
  return fmt::format(
      "ngspice, {} to {} Hz: {} dB from the program's own response, {} dB from the sections; a triangle within {} %, "
      "noise within {} %\n",
      rounded_text(check.band.from.value), rounded_text(check.band.to.value),
      rounded_text(check.against_network.max_magnitude_db, 3),
      rounded_text(check.against_sections.max_magnitude_db, 3), rounded_text(check.transient_percent, 3),
      rounded_text(check.noise_percent, 3));
}

void write_circuit(const CommandLine& line, const circuit::Realised& made, const Json& circuit) {
  OutputSet out(line.output_path());
  const std::string title = fmt::format("compensator from {}", line.files()[0]);
  spice::add_spice_files(made, title, out);
  kicad::add_kicad_files(made.circuit, title, out);
  out.add("circuit.json", to_text(circuit));
  out.commit();
}

}  // namespace

int run_spice(const std::vector<std::string>& arguments) {
  CommandLine line("spice", "bodesmith spice sections.json -o spice/ --check",
                   "Sections as op-amp RC circuits with parts that can be bought, and portable netlists.");
  declare_spice(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const circuit::RealiseOptions options = read_spice_options(line, from);
  const std::optional<double> limit = line.maybe_positive("max-error-db");
  require_ngspice_for_check(line);
  const Sections sections = rational_part(Sections::read(line.files()[0], from), line.files()[0]);
  const double amplitude_v = line.positive("amplitude-v");

  const Stopwatch watch;
  const circuit::Realised made =
      automatic_opamp(line)
          ? circuit::realise_with_best_opamp(sections, options, library_of(line, from), amplitude_v)
          : circuit::realise(sections, options);
  const circuit::OpAmpCheck opamps = circuit::check_opamps(made.circuit, made.report.band, amplitude_v);
  const double compute_s = watch.seconds();
  warn_each(opamps.warnings);

  Json circuit = json_header("circuit", from);
  circuit.update(to_json(made));
  circuit["opamp_check"] = to_json(opamps);
  circuit["timing_s"] = {{"compute", compute_s}};
  std::string text = circuit_summary(made, options, opamps);
  if (line.has("check")) {
    const spice::CompensatorCheck check = spice::check_compensator(made.circuit, sections);
    circuit["ngspice"] = to_json(check);
    text += check_text(check);
  }
  const bool met = !limit || made.report.all.max_magnitude_db <= *limit;
  if (!met) {
    text += limit_not_met(*limit, "dB");
    circuit["limit_missed"] = true;
  }
  write_circuit(line, made, circuit);
  print_summary(line, text, circuit);
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
