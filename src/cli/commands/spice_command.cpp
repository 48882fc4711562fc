#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/shared_options.hpp"
#include "lti/steep_flanks.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/opamp_check.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/realise_search.hpp"

namespace bodesmith::cli {
namespace {

void declare_spice(CommandLine& line) {
  line.positional("SECTIONS.json...", 1, -1);
  line.output(
      "folder for compensator.sub, decks for ngspice, LTspice and Xyce, a KiCad project, parts.csv and "
      "circuit.json");
  add_circuit_options(line);
  add_parts_options(line);
  add_tolerance_options(line);
  line.option<double>("amplitude-v", "largest input, for the checks of slew rate and swing", 1.0);
  line.option<double>(
      "max-error-db",
      "exit with 1 when the error of parts and op-amps together against the sections is larger");
  line.flag(
      "allow-shortfall",
      "exit with 0 although an op-amp has less than 30 degrees of phase margin, or parts and op-amps are more "
      "than 3 dB off in the band of the sections");
  line.band("band of the search and of the errors (default: 1/10 of the lowest corner",
            "to 10 times the highest, at most a decade beyond the sections' own band)");
  add_check_option(line, "run ngspice and compare with the program's own response");
}

std::string circuit_summary(const synthesis::BuildChoice& choice, const synthesis::RealiseOptions& options) {
  const synthesis::Realised& made = choice.best.made;
  const synthesis::OpAmpCheck& opamps = choice.best.opamps;
  const synthesis::RealiseReport& report = made.report;
  return fmt::format(
             "{}: {} stages, {} op-amps, {} parts ({} resistors, {} capacitors)\n"
             "parts against the sections, {} to {}: {} dB, {} deg ({} dB with every value rounded on its own)\n"
             "op-amps ({}): {} dB; all together: {} dB, {} deg\n",
             choice.best.how, made.circuit.stages.size(), made.circuit.opamps.size(),
             made.circuit.parts.size(), options.resistors.name(), options.capacitors.name(),
             engineering_text(report.band.from.value, "Hz"), engineering_text(report.band.to.value, "Hz"),
             rounded_text(report.parts.max_magnitude_db, 3), rounded_text(report.parts.max_phase_deg, 3),
             rounded_text(report.nearest.max_magnitude_db, 3), made.circuit.opamp.name,
             rounded_text(report.opamps.max_magnitude_db, 3), rounded_text(report.all.max_magnitude_db, 3),
             rounded_text(report.all.max_phase_deg, 3)) +
         fmt::format(
             "in the band of the sections, {} to {}: {} dB, {} deg\n"
             "phase margin of every op-amp {} deg or more; offset at most {}; noise {} rms over the band\n",
             engineering_text(choice.best.judged_band.from.value, "Hz"),
             engineering_text(choice.best.judged_band.to.value, "Hz"),
             rounded_text(choice.best.judged.max_magnitude_db, 3),
             rounded_text(choice.best.judged.max_phase_deg, 3), rounded_text(opamps.min_phase_margin_deg, 3),
             opamps.output_offset_v > made.circuit.opamp.swing_v
                 ? "its swing (it rests only in a loop)"
                 : engineering_text(opamps.output_offset_v, "V"),
             engineering_text(opamps.noise_rms_v, "V"));
}

std::string check_text(const synthesis::CompensatorCheck& check) {
  return fmt::format(
      "ngspice, {} to {}: {} dB from the program's own response, {} dB from the sections; a triangle within {} %, "
      "noise within {} %\n",
      engineering_text(check.band.from.value, "Hz"), engineering_text(check.band.to.value, "Hz"),
      rounded_text(check.against_network.max_magnitude_db, 3),
      rounded_text(check.against_sections.max_magnitude_db, 3), rounded_text(check.transient_percent, 3),
      rounded_text(check.noise_percent, 3));
}

void write_circuit(const CommandLine& line, const synthesis::Realised& made, const Json& circuit) {
  OutputSet out(line.output_path());
  const std::string title = "compensator from " + join(line.files(), ", ");
  synthesis::add_compensator_files(made, title, out);
  out.add("circuit.json", to_text(circuit));
  out.commit();
}

}  // namespace

int run_spice(const std::vector<std::string>& arguments) {
  CommandLine line(
      "spice", "bodesmith spice sections.json -o spice/ --check",
      "Sections as op-amp RC circuits with parts that can be bought, and portable netlists. Several files are\n"
      "one circuit, one after the other.");
  declare_spice(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  synthesis::RealiseOptions options = read_parts_options(line, from);
  options.band = line.maybe_band();
  options.tolerances = read_tolerances(line, options.tolerances);
  const std::optional<double> limit = line.maybe_positive("max-error-db");
  const bool shortfall_allowed = line.has("allow-shortfall");
  require_ngspice_for_check(line);
  const Sections sections = read_rational_series(line.files(), from);

  const Stopwatch watch;
  const synthesis::BuildChoice choice =
      design_circuit(line, sections, options, from, line.positive("amplitude-v"));
  const synthesis::Realised& made = choice.best.made;
  const double compute_s = watch.seconds();
  warn_each(choice.best.opamps.warnings);
  for (const std::string& reason : choice.passed_over)
    note(fmt::format("{}; made as {}", reason, choice.best.how));

  Json circuit = to_json(made);
  circuit["realization"] = choice.best.realisation;
  circuit["made_as"] = choice.best.how;
  circuit["passed_over"] = choice.passed_over;
  circuit["opamp_check"] = to_json(choice.best.opamps);
  circuit["judged"] = synthesis::judged_json(choice.best.judged, choice.best.judged_band);
  circuit["shortfalls"] = choice.best.shortfalls;
  circuit = timed_document("circuit", from, circuit, compute_s);
  std::string text = circuit_summary(choice, options);
  if (has_flanks([&](Hertz f) { return sections.response(f.rad_s()); }, made.report.band))
    text += std::string(kFlanksText) + "\n";
  if (line.has("check")) {
    const synthesis::CompensatorCheck check = synthesis::check_compensator(made.circuit, sections);
    circuit["ngspice"] = to_json(check);
    text += check_text(check);
  }
  const bool met = keeps_limit(limit, made.report.all.max_magnitude_db, "dB", text, circuit);
  for (const std::string& shortfall : choice.best.shortfalls)
    text += shortfall + (shortfall_allowed ? " (allowed)\n" : ": NOT met\n");
  write_circuit(line, made, circuit);
  return print_summary(line, text, circuit, met && (choice.best.shortfalls.empty() || shortfall_allowed));
}

}  // namespace bodesmith::cli
