#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "numeric/departure.hpp"
#include "schematic/netlist.hpp"
#include "synthesis/generator/circuit.hpp"

namespace bodesmith::generator {

/// How far the parts of a built controller, or of its generator alone, are off. Resistors, capacitors and references are anywhere within their
/// tolerance (uniform); everything else is normal, the figure being the standard deviation (what data sheets call
/// typical), cut at three of them. Every part is drawn by itself, but for the op-amps' speed, which is one lot's.
struct PartErrors : schematic::Tolerances {
  PartErrors() : Tolerances(kPreciseParts) {}
  double reference_percent = 0.05;
  double multiplier_input_v = 3e-3;   ///< offset of X and of Y; the other input's feedthrough is that over U
  double multiplier_output_v = 5e-3;  ///< offset of W
  double multiplier_scale_percent = 1.0;         ///< of U, as delivered
  double multiplier_nonlinearity_percent = 0.2;  ///< of the product
  double opamp_offset_share = 1.0 / 3.0;  ///< of the offset in the op-amp's model (a data sheet's maximum)
  double opamp_speed_percent = 20.0;      ///< gain-bandwidth and slew rate
  double switch_ohm_percent = 20.0;
  double switch_charge_c = 5e-12;
  double switch_timing_percent = 20.0;  ///< of the slope detector's and the switch's delays

  /// Every figure by its name as in `[hardware.controller.errors]` and controller.json.
  struct Named {
    const char* name;
    double PartErrors::*value;
  };
  static const std::vector<Named>& names();
  /// Sets the figure of that name; where there is none what is wrong with it: "is not known, expected one of …".
  std::optional<std::string> set(const std::string& name, double to);
  /// A table with any of those names; others are errors with file and line.
  static PartErrors from_node(const Node& node);
};

/// One copy that was built.
struct Copy {
  schematic::Deviations off;
  double speed = 0.0;   ///< relative, of every op-amp's gain-bandwidth and slew rate
  double timing = 0.0;  ///< relative, of the slope detector's and the switch's delays
};

/// One thing that may be off.
struct Cause {
  std::string name;   ///< "M2, offset of X", "Ra1, tolerance"
  std::string group;  ///< "multiplier offsets", "resistors"
  Departure departure;
  std::function<void(Copy&, double value)> apply;  ///< adds the value
};

/// Every part of the controller, in the order of the description.
std::vector<Cause> causes_of(const DisturbanceCircuit& controller, const PartErrors& errors);

/// Values of all causes for copy number `sample`.
std::vector<double> draw_values(const std::vector<Cause>& causes, std::uint64_t seed, std::uint64_t sample);
Copy copy_of(const DisturbanceCircuit& controller, const std::vector<Cause>& causes,
             const std::vector<double>& values);

/// Every multiplier with all its departures at one standard deviation of what is assumed, upwards.
schematic::Deviations multipliers_off(const DisturbanceCircuit& layout);
/// Every figure by its name.
Json to_json(const PartErrors& errors);

}  // namespace bodesmith::generator
