#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "fpaa/network/periodic_network.hpp"

namespace bodesmith::fpaa {

/// A switched-capacitor circuit with its clocks, as SPICE writes it (schematic::read_spice): from the input to the output of
/// the file's last circuit, capacitors, switches and op-amps alone. Clocks' frequencies stand in ratios of whole numbers.
struct SwitchedNetlist {
  SwitchedCircuit circuit;  ///< capacitors in units of `unit_f`
  double unit_f = 1e-12;
  std::vector<Hertz> clocks;
  std::vector<std::int64_t> ticks;  ///< of each clock's period
  double ticks_per_second = 1.0;

  /// Throws InputError with the file and, where there is one, the line.
  static SwitchedNetlist read(std::string_view text, const std::string& file);

  /// With the noise of switches at a temperature and of op-amps. Throws DesignError where a voltage is not determined.
  PeriodicNetworks networks(std::optional<double> temperature_k = {}) const;

  /// kT over the unit of capacitance, V^2.
  double thermal_v2(double temperature_k) const;
};

}  // namespace bodesmith::fpaa
