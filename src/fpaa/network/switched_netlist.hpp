#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "fpaa/network/periodic_network.hpp"

namespace bodesmith::fpaa {

/// A switched-capacitor circuit as text, one element a line, as SPICE writes it (letters of either case, `*` and `;`
/// begin comments, values with f p n u m k meg g):
/// \verbatim
///   .clock NAME FREQUENCY       phase 1 is the first half of its period; all clocks begin at t = 0
///   V1 NODE 0                   the input
///   Cname NODE NODE VALUE       capacitor, farads
///   Sname NODE NODE CLOCK.PHASE switch, closed in phase 1 or 2 of a clock
///   Oname PLUS MINUS OUT [noise=V/rtHz gbw=HZ]   op-amp, ideal but for noise at its input and the bandwidth that limits it
///   .output NODE
/// \endverbatim
/// Node 0 is ground. Clocks' frequencies stand in ratios of whole numbers.
struct SwitchedNetlist {
  SwitchedNetwork network;  ///< capacitors in units of `unit_f`
  double unit_f = 1e-12;
  std::vector<double> opamp_noise_v_per_rthz;  ///< of each op-amp of the network
  std::vector<std::string> clocks;
  std::vector<Hertz> frequencies;
  std::vector<std::int64_t> ticks;  ///< of each clock's period
  double ticks_per_second = 1.0;

  /// Throws InputError with file and line.
  static SwitchedNetlist read(std::string_view text, const std::string& file);

  /// With the noise of switches at a temperature and of op-amps. Throws DesignError where a voltage is not determined.
  PeriodicNetworks networks(std::optional<double> temperature_k = {}) const;

  /// kT over the unit of capacitance, V^2.
  double thermal_v2(double temperature_k) const;
};

}  // namespace bodesmith::fpaa
