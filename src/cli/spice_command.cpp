#include <fmt/format.h>

#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "circuit/json.hpp"
#include "circuit/opamp_check.hpp"
#include "circuit/opamp_library.hpp"
#include "circuit/realise.hpp"
#include "circuit/realise_ladder.hpp"
#include "circuit/stock.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "kicad/schematic.hpp"
#include "spice/compensator_check.hpp"
#include "spice/emit.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

void declare(CommandLine& line) {
  line.positional("SECTIONS.json", 1, 1);
  line.output(
      "folder for compensator.sub, decks for ngspice, LTspice and Xyce, a KiCad project, parts.csv and "
      "circuit.json");
  line.options().add_options()(
      "realization", po::value<std::string>()->default_value("opamp-rc"),
      "opamp-rc (chooses for each stage); one form for all: first-order, tow-thomas, khn, sallen-key, "
      "multiple-feedback; or RC ladders for poles and zeros that alternate: foster1, foster2, cauer1, "
      "cauer2")("series", po::value<std::string>()->default_value("E96"),
                "series of the resistors, E3 to E192; exact: values as computed, capacitors too")(
      "capacitor-series", po::value<std::string>(),
      "series of the capacitors (E12, or exact with --series exact)")(
      "stock", po::value<std::string>(),
      "parts at hand instead of series, TOML (bodesmith.stock/1: values_ohm, values_f, limits) or CSV "
      "(resistance_ohm,capacitance_f, one value a row)")("min-ohm", po::value<double>()->default_value(1e3),
                                                         "least resistor (ladders: 100)")(
      "max-ohm", po::value<double>()->default_value(2.2e6), "greatest resistor (ladders: 1e7)")(
      "min-f", po::value<double>()->default_value(47e-12), "least capacitor")(
      "max-f", po::value<double>()->default_value(220e-9), "greatest capacitor (ladders: 4.7e-6)")(
      "isolation-ohm", po::value<double>(),
      "in series with the input capacitor of first-order stages, so that the op-amp before does not ring "
      "(default: a fifth of its "
      "output resistance where the band allows it; 0: none)")(
      "opamp", po::value<std::string>()->default_value("generic-10M"),
      "type of op-amp; auto: the first of the list that is good enough; ideal")(
      "opamp-library", po::value<std::string>(), "a TOML list of op-amps of your own")(
      "amplitude-v", po::value<double>()->default_value(1.0),
      "greatest input, for the checks of slew rate and swing")(
      "max-error-db", po::value<double>(),
      "exit with 1 when parts and op-amps together miss the sections by more")(
      "from-hz", po::value<double>(),
      "band of the search and of the errors (default: 1/10 of the lowest corner")(
      "to-hz", po::value<double>(), "to 10 times the highest)")(
      "check", "run ngspice and compare with the program's own response");
}

circuit::OpAmpLibrary library_of(const CommandLine& line, Provenance& from) {
  if (const auto file = line.maybe<std::string>("opamp-library"))
    return circuit::OpAmpLibrary::read(*file, from);
  return circuit::OpAmpLibrary::built_in();
}

circuit::RealiseOptions read_options(const CommandLine& line, Provenance& from) {
  circuit::RealiseOptions options;
  options.realization = line.get<std::string>("realization");
  options.resistors = circuit::Series::named(line.get<std::string>("series"));
  options.capacitors = circuit::Series::named(
      line.maybe<std::string>("capacitor-series").value_or(options.resistors.is_exact() ? "exact" : "E12"));
  // A list's own limits stand before the usual ones, and behind those that are typed.
  const bool ladder = circuit::ladder_form_named(options.realization).has_value();
  if (ladder) circuit::set_ladder_limits(options);
  if (line.has("stock")) circuit::StockList::read(line.get<std::string>("stock"), from).apply_to(options);
  const auto limit = [&](const char* name, double& value) {
    const double given = line.positive(name);
    if (line.has(name) || !(ladder || line.has("stock"))) value = given;
  };
  limit("min-ohm", options.least_ohm);
  limit("max-ohm", options.greatest_ohm);
  limit("min-f", options.least_f);
  limit("max-f", options.greatest_f);
  if (line.has("stock") && options.resistors.is_exact() != options.capacitors.is_exact()) {
    line.fail("--stock does not mix with exact parts, expected a series for what the list leaves out");
  }
  if (line.has("isolation-ohm")) {
    const double ohm = line.get<double>("isolation-ohm");
    if (!(ohm >= 0.0) || ohm > 1e6) line.fail("--isolation-ohm is out of range, expected 0 to 1e6");
    options.isolation_ohm = ohm;
  }
  if (line.get<std::string>("opamp") != "auto")
    options.opamp = library_of(line, from).named(line.get<std::string>("opamp"));
  if (line.has("from-hz") != line.has("to-hz")) line.fail("--from-hz and --to-hz belong together");
  if (line.has("from-hz")) {
    options.band = Band{Hertz{line.positive("from-hz")}, Hertz{line.positive("to-hz")}};
    if (!(options.band->from < options.band->to)) line.fail("--from-hz is not below --to-hz");
  }
  return options;
}

}  // namespace

int run_spice(const std::vector<std::string>& arguments) {
  CommandLine line("spice", "bodesmith spice sections.json -o spice/ --check",
                   "Sections as op-amp RC circuits with parts that can be bought, and portable netlists.");
  declare(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  circuit::RealiseOptions options = read_options(line, from);
  if (line.has("max-error-db")) line.positive("max-error-db");
  if (line.has("check") && !spice::ngspice_available()) {
    line.fail("--check needs ngspice, which is not installed (Debian: apt-get install ngspice)");
  }
  const Sections sections = Sections::read(line.files()[0], from);
  const double amplitude_v = line.positive("amplitude-v");

  const Stopwatch watch;
  const circuit::Realised made =
      line.get<std::string>("opamp") == "auto"
          ? circuit::realise_with_best_opamp(sections, options, library_of(line, from), amplitude_v)
          : circuit::realise(sections, options);
  const circuit::OpAmpCheck opamps = circuit::check_opamps(made.circuit, made.report.band, amplitude_v);
  const double compute_s = watch.seconds();
  for (const std::string& warning : opamps.warnings) note("warning: " + warning);

  Json circuit = json_header("circuit", from);
  circuit.update(to_json(made));
  circuit["opamp_check"] = to_json(opamps);
  circuit["timing_s"] = {{"compute", compute_s}};
  const circuit::RealiseReport& report = made.report;
  std::string text = fmt::format(
      "{} stages, {} op-amps, {} parts ({} resistors, {} capacitors)\n"
      "parts against the sections, {} to {} Hz: {} dB, {} deg ({} dB with every value rounded on its own)\n"
      "op-amps ({}): {} dB; all together: {} dB, {} deg\n",
      made.circuit.stages.size(), made.circuit.opamps.size(), made.circuit.parts.size(),
      options.resistors.name(), options.capacitors.name(), rounded_text(report.band.from.value),
      rounded_text(report.band.to.value), rounded_text(report.parts.max_magnitude_db, 3),
      rounded_text(report.parts.max_phase_deg, 3), rounded_text(report.nearest.max_magnitude_db, 3),
      made.circuit.model.name, rounded_text(report.opamps.max_magnitude_db, 3),
      rounded_text(report.all.max_magnitude_db, 3), rounded_text(report.all.max_phase_deg, 3));
  text += fmt::format(
      "phase margin of every op-amp {} deg or more; offset at most {} V; noise {} V rms over the band\n",
      rounded_text(opamps.least_phase_margin_deg, 3), rounded_text(opamps.output_offset_v, 3),
      rounded_text(opamps.noise_rms_v, 3));
  if (line.has("check")) {
    const spice::CompensatorCheck check = spice::check_compensator(made.circuit, sections);
    circuit["ngspice"] = {{"version", spice::ngspice_version()},
                          {"band_hz", {check.band.from.value, check.band.to.value}},
                          {"against_program", circuit::to_json(check.against_network)},
                          {"against_sections", circuit::to_json(check.against_sections)},
                          {"transient_percent", check.transient_percent},
                          {"noise_percent", check.noise_percent}};
    text += fmt::format(
        "ngspice, {} to {} Hz: {} dB from the program's own response, {} dB from the sections; a triangle "
        "within {} "
        "%, noise within {} %\n",
        rounded_text(check.band.from.value), rounded_text(check.band.to.value),
        rounded_text(check.against_network.max_magnitude_db, 3),
        rounded_text(check.against_sections.max_magnitude_db, 3), rounded_text(check.transient_percent, 3),
        rounded_text(check.noise_percent, 3));
  }
  int status = kDone;
  if (const auto limit = line.maybe<double>("max-error-db"); limit && report.all.max_magnitude_db > *limit) {
    text += fmt::format("the limit of {} dB is not met\n", rounded_text(*limit));
    circuit["limit_missed"] = true;
    status = kLimitMissed;
  }
  OutputSet out(line.output_path());
  const std::string title = fmt::format("compensator from {}", line.files()[0]);
  spice::add_spice_files(made, title, out);
  kicad::add_kicad_files(made.circuit, title, out);
  out.add("circuit.json", to_text(circuit));
  out.commit();
  print_summary(line, text, circuit);
  return status;
}

}  // namespace bodesmith::cli
