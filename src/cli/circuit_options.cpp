#include "cli/circuit_options.hpp"

#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/parts/stock.hpp"
#include "synthesis/realisation.hpp"

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

circuit::RealiseOptions read_circuit_options(const CommandLine& line) {
  circuit::RealiseOptions options;
  options.realisation = line.get<std::string>("realization");
  options.resistors = circuit::Series::named(line.get<std::string>("series"));
  options.capacitors = circuit::Series::named(
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

schematic::OpAmpLibrary opamp_library_of(const CommandLine& line, Provenance& from) {
  if (const auto file = line.maybe<std::string>("opamp-library"))
    return schematic::OpAmpLibrary::read(*file, from);
  return schematic::OpAmpLibrary::built_in();
}

bool automatic_opamp(const CommandLine& line) {
  return line.get<std::string>("opamp") == "auto";
}

namespace {

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

}  // namespace

bool parts_limits_given(const CommandLine& line) {
  for (const char* limit : {"stock", "min-ohm", "max-ohm", "min-f", "max-f"}) {
    if (line.has(limit)) return true;
  }
  return false;
}

circuit::RealiseOptions read_parts_options(const CommandLine& line, Provenance& from) {
  circuit::RealiseOptions options = read_circuit_options(line);
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

void add_check_option(CommandLine& line, const std::string& what) {
  line.flag("check", what);
}

void require_ngspice_for_check(const CommandLine& line) {
  if (line.has("check") && !spice::ngspice_available()) {
    line.fail("--check needs ngspice, which is not installed (Debian: apt-get install ngspice)");
  }
}

}  // namespace bodesmith::cli
