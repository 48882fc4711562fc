#include "cli/circuit_options.hpp"

#include "spice/ngspice.hpp"

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

void add_check_option(CommandLine& line, const std::string& what) {
  line.flag("check", what);
}

void require_ngspice_for_check(const CommandLine& line) {
  if (line.has("check") && !spice::ngspice_available()) {
    line.fail("--check needs ngspice, which is not installed (Debian: apt-get install ngspice)");
  }
}

}  // namespace bodesmith::cli
