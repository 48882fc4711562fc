#include "cli/shared_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "lti/section_making.hpp"
#include "schematic/ngspice/ngspice_process.hpp"
#include "simulate/controller_file.hpp"
#include "synthesis/parts/stock.hpp"
#include "synthesis/realisation.hpp"
#include "tuning/controller_kind.hpp"

namespace bodesmith::cli {

void add_circuit_options(CommandLine& line) {
  line.option<std::string>(
      "realization",
      "opamp-rc (chooses for each stage); one form for all: first-order, tow-thomas, khn, "
      "sallen-key, multiple-feedback; or RC ladders for poles and zeros that alternate: foster1, "
      "foster2, cauer1, cauer2",
      "opamp-rc");
  line.option<std::string>(
      "series", "series of the resistors, E3 to E192; exact: values as computed, capacitors too", "E96");
  line.option<std::string>("capacitor-series",
                           "series of the capacitors (default: E12, or exact with --series exact)");
}

synthesis::RealiseOptions read_circuit_options(const CommandLine& line) {
  synthesis::RealiseOptions options;
  options.realisation = line.get<std::string>("realization");
  options.resistors = synthesis::Series::named(line.get<std::string>("series"));
  options.capacitors = synthesis::Series::named(
      line.maybe<std::string>("capacitor-series").value_or(options.resistors.is_exact() ? "exact" : "E12"));
  return options;
}

void add_parts_options(CommandLine& line) {
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
}

void add_tolerance_options(CommandLine& line, schematic::Tolerances otherwise) {
  line.option<double>("resistor-percent",
                      fmt::format("tolerance of the resistors (default: circuit.json's, else {})",
                                  otherwise.resistor_percent));
  line.option<double>("capacitor-percent",
                      fmt::format("tolerance of the capacitors (default: circuit.json's, else {})",
                                  otherwise.capacitor_percent));
}

schematic::Tolerances read_tolerances(const CommandLine& line, schematic::Tolerances out) {
  out.resistor_percent = line.maybe<double>("resistor-percent").value_or(out.resistor_percent);
  out.capacitor_percent = line.maybe<double>("capacitor-percent").value_or(out.capacitor_percent);
  for (const double percent : {out.resistor_percent, out.capacitor_percent}) {
    if (!(percent >= 0.0) || percent >= 100.0)
      line.fail(
          fmt::format("a tolerance of {} % was asked for, expected 0 or more and less than 100", percent));
  }
  return out;
}

namespace {

schematic::OpAmpLibrary opamp_library_of(const CommandLine& line, Provenance& from) {
  if (const auto file = line.maybe<std::string>("opamp-library"))
    return schematic::OpAmpLibrary::read(*file, from);
  return schematic::OpAmpLibrary::built_in();
}

bool automatic_opamp(const CommandLine& line) {
  return line.get<std::string>("opamp") == "auto";
}

/// Limits of the values: the form's or the stock list's own, then those that were given.
void read_value_limits(const CommandLine& line, Provenance& from, synthesis::RealiseOptions& options) {
  options.limits = synthesis::realisation_registry().get(options.realisation).usual_limits();
  if (line.has("stock")) synthesis::StockList::read(line.get<std::string>("stock"), from).apply_to(options);
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

}  // namespace

synthesis::RealiseOptions read_parts_options(const CommandLine& line, Provenance& from) {
  synthesis::RealiseOptions options = read_circuit_options(line);
  read_value_limits(line, from, options);
  if (line.has("isolation-ohm")) {
    const double ohm = line.get<double>("isolation-ohm");
    if (!(ohm >= 0.0) || ohm > 1e6) line.fail("--isolation-ohm is out of range, expected 0 to 1e6");
    options.isolation_ohm = ohm;
  }
  if (!automatic_opamp(line))
    options.opamp = opamp_library_of(line, from).named(line.get<std::string>("opamp"));
  return options;
}

synthesis::BuildChoice design_circuit(const CommandLine& line, const Sections& sections,
                                      const synthesis::RealiseOptions& options, Provenance& from,
                                      double amplitude_v) {
  synthesis::BuildSearch search;
  search.options = options;
  search.may_choose = !line.has("realization");
  for (const char* limit : {"stock", "min-ohm", "max-ohm", "min-f", "max-f"})
    search.limits_given = search.limits_given || line.has(limit);
  search.amplitude_v = amplitude_v;
  std::optional<schematic::OpAmpLibrary> library;
  if (automatic_opamp(line)) search.opamps = &library.emplace(opamp_library_of(line, from));
  return value_or_throw(synthesis::realise_for_building(sections, search));
}

void add_check_option(CommandLine& line, const std::string& what) {
  line.flag("check", what);
}

void require_ngspice_for_check(const CommandLine& line) {
  if (line.has("check") && !ngspice::is_available()) {
    line.fail("--check needs ngspice, which is not installed (Debian: apt-get install ngspice)");
  }
}

void add_mismatch_options(CommandLine& line) {
  const fpaa::MismatchModel m;
  line.option<double>(
      "unit-capacitor-percent",
      fmt::format("FPAA, an assumption: standard deviation of one unit; n units have 1/sqrt(n) of it "
                  "(default: the plan's, else {})",
                  m.unit_percent));
  line.option<double>("systematic-units",
                      "FPAA, an assumption: excess of every capacitor, in units, of wiring "
                      "(default: the plan's, else 0)");
}

fpaa::MismatchModel read_mismatch(const CommandLine& line, fpaa::MismatchModel out) {
  out.unit_percent = line.maybe<double>("unit-capacitor-percent").value_or(out.unit_percent);
  out.systematic_units = line.maybe<double>("systematic-units").value_or(out.systematic_units);
  if (!(out.unit_percent >= 0.0) || !(out.unit_percent < 100.0)) {
    line.fail(fmt::format("--unit-capacitor-percent is {}, expected 0 or more and less than 100",
                          out.unit_percent));
  }
  if (!(std::abs(out.systematic_units) < 1.0)) {
    line.fail(
        fmt::format("--systematic-units is {}, expected more than -1 and less than 1", out.systematic_units));
  }
  return out;
}

void add_hold_options(CommandLine& line) {
  line.flag("with-holds", "FPAA plans: as the board runs, which is the default");
  line.flag("without-holds", "FPAA plans: the capacitors' exact transfer function alone");
}

bool as_it_runs(const CommandLine& line) {
  if (line.has("with-holds") && line.has("without-holds"))
    line.fail("--with-holds and --without-holds cannot be combined");
  return !line.has("without-holds");
}

void add_slow_options(CommandLine& line) {
  const fpaa::SlowParts typical = fpaa::SlowParts::typical();
  line.option<double>(
      "opamp-bandwidth-hz",
      "gain-bandwidth product of an op-amp: how late it follows is in every figure then (default: at once)");
  line.option<double>("opamp-gain", "with it: DC gain of an op-amp", typical.opamp.dc_gain);
  line.option<double>("switch-ohm", "resistance of a closed switch, likewise (default: none)");
}

fpaa::SlowParts read_slow_parts(const CommandLine& line) {
  const std::optional<double> bandwidth_hz = line.maybe_positive("opamp-bandwidth-hz");
  // Without a bandwidth it is not read, and refused where it was given.
  const double gain = bandwidth_hz ? line.positive("opamp-gain") : 0.0;
  return fpaa::SlowParts::given(bandwidth_hz, gain, line.maybe_positive("switch-ohm"),
                                read_noise_model(line).unit_capacitance_f);
}

void add_noise_options(CommandLine& line) {
  const fpaa::NoiseModel n;
  line.option<double>("unit-capacitance-f",
                      "an assumption, for noise in uV and the ngspice netlist: capacitance of one unit",
                      n.unit_capacitance_f);
  line.option<double>("noise-temperature-k", "temperature of the switches, for kT/C noise", n.temperature_k);
  line.option<double>(
      "noise-weight",
      "FPAA search: kT/C noise in the band, as a share of a full-scale sine, times this counts as error",
      n.weight);
}

fpaa::NoiseModel read_noise_model(const CommandLine& line) {
  const double weight = line.get<double>("noise-weight");
  if (!(weight >= 0.0)) line.fail(fmt::format("--noise-weight is {}, expected 0 or more", weight));
  const double unit_f = line.get<double>("unit-capacitance-f");
  if (!(unit_f >= 1e-18 && unit_f <= 1e-6))
    line.fail(fmt::format("--unit-capacitance-f is {}, expected 1e-18 to 1e-6 F", unit_f));
  return {unit_f, line.positive("noise-temperature-k"), weight};
}

namespace {

constexpr double kSamplesAPeriod = 500.0;
constexpr double kSamplesOfTheHighest = 20.0;
constexpr double kPeriods = 3.0;

}  // namespace

void add_reference_options(CommandLine& line, UsualLength usual) {
  const bool periods = usual == UsualLength::periods;
  line.option<double>("frequency-hz", "frequency of the reference; lowest one of a chirp or multisine", 1.0);
  line.option<double>("last-hz", "highest frequency of a chirp or multisine", 100.0);
  line.option<double>("amplitude", "half the height of the reference", 0.5);
  line.option<double>("offset", "middle of the reference (default: the amplitude, so that it starts at 0)");
  line.option<double>(
      "duration-s", fmt::format("length of the reference (default: {})", periods ? "three periods" : "1 s"));
  line.option<double>(
      "step-s", fmt::format("time between its samples (default: {})", periods ? "500 a period" : "1 ms"));
  line.option<int>("steps", "levels of a stair", 10);
}

simulate::ReferenceSpec read_reference_options(const CommandLine& line, const std::string& kind,
                                               UsualLength usual) {
  simulate::ReferenceSpec spec;
  spec.kind = simulate::reference_kind(kind);
  spec.frequency = Hertz{line.positive("frequency-hz")};
  spec.amplitude = line.positive("amplitude");
  // What a kind has none of is not read, and refused where it was given.
  const bool wide = kind == "chirp" || kind == "multisine";
  if (wide) spec.last = Hertz{line.positive("last-hz")};
  if (spec.kind == "stair") spec.steps = line.get<int>("steps");
  spec.offset = line.maybe<double>("offset").value_or(spec.amplitude);
  const double period = 1.0 / simulate::fundamental_of(spec).value_or(spec.frequency).value;
  const bool periods = usual == UsualLength::periods;
  spec.duration_s = line.maybe_positive("duration-s").value_or(periods ? kPeriods * period : 1.0);
  const double step = wide
                          ? std::min(period / kSamplesAPeriod, 1.0 / (kSamplesOfTheHighest * spec.last.value))
                          : period / kSamplesAPeriod;
  spec.step_s = line.maybe_positive("step-s").value_or(periods ? step : 1e-3);
  spec.seed = line.seed_value();
  return spec;
}

bool names_a_reference(const std::string& text) {
  std::error_code ignored;
  if (std::filesystem::exists(text, ignored)) return false;
  const auto& kinds = simulate::reference_kinds();
  return std::ranges::find(kinds, simulate::reference_kind(text), &simulate::ReferenceKind::name) !=
         kinds.end();
}

Sections rational_part(Sections sections, const std::string& file) {
  if (sections.delay_s != 0.0) {
    note(fmt::format("{}: its delay of {} is left out, poles and zeros do not make it", file,
                     engineering_text(sections.delay_s, "s")));
    sections.delay_s = 0.0;
  }
  return sections;
}

Sections sections_of(const Node& node, const std::filesystem::path& folder, Provenance& from) {
  if (node.kind() != Node::Kind::object || node.string_or("schema", "") != "bodesmith.controller/1")
    return Sections::from_node(node);
  const simulate::LoopSetup loop = simulate::controller_from_node(node, folder, from);
  return tuning::SeriesController{loop.controller, loop.filter.value_or(Sections{})}.sections();
}

Sections read_rational_series(const std::vector<std::string>& files, Provenance& from) {
  std::vector<Sections> parts;
  for (const std::string& file : files) {
    const Node node = read_document(file, from);
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    parts.push_back(rational_part(sections_of(node, folder, from), file));
  }
  return in_series(parts);
}

void add_load_option(CommandLine& line) {
  line.option<double>(
      "load-stroke",
      "share of the stroke that a stiff load leaves: the disturbance is taken over from its amplitude "
      "gains (disturbance paper, V.C.2)");
}

}  // namespace bodesmith::cli
