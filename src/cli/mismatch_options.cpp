#include "cli/mismatch_options.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bodesmith::cli {

void add_mismatch_options(CommandLine& line) {
  const fpaa::MismatchModel m;
  line.option<double>("unit-capacitor-percent",
                      "FPAA, an assumption: standard deviation of one unit; n units have 1/sqrt(n) of it",
                      m.unit_percent);
  line.option<double>("systematic-units",
                      "FPAA, an assumption: what every capacitor has too much, in units (wiring)",
                      m.systematic_units);
}

fpaa::MismatchModel read_mismatch(const CommandLine& line) {
  fpaa::MismatchModel out;
  out.unit_percent = line.get<double>("unit-capacitor-percent");
  out.systematic_units = line.get<double>("systematic-units");
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

void add_opamp_options(CommandLine& line) {
  const fpaa::OpAmpModel opamp;
  line.option<double>("opamp-bandwidth-hz",
                      "an assumption, for settling: gain-bandwidth product of an op-amp",
                      opamp.gain_bandwidth.value);
  line.option<double>("opamp-gain", "an assumption: gain of an op-amp at DC", opamp.gain);
}

fpaa::OpAmpModel read_opamp_model(const CommandLine& line) {
  return {{line.positive("opamp-bandwidth-hz")}, line.positive("opamp-gain")};
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
  return {line.positive("unit-capacitance-f"), line.positive("noise-temperature-k"), weight};
}

}  // namespace bodesmith::cli
