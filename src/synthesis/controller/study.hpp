#pragma once

#include <vector>

#include "base/documents/json_fwd.hpp"
#include "schematic/netlist.hpp"
#include "synthesis/controller/as_built.hpp"
#include "synthesis/controller/library.hpp"

namespace bodesmith::generator {

/// The netlist along one reference by both engines.
struct BothEngines {
  SteadyState ngspice, cvode;
  /// rms of v between them over the time, percent of the reference's range: at ngspice's own instants, which lie close where v jumps
  /// (between even samples a jump counts for a whole one or not at all).
  double difference_percent = 0.0;
};
BothEngines run_in_both(const DisturbanceCircuit& controller, const tracking::Reference& reference,
                        Hertz operating, const NgspiceRun& options);

/// One tracked frequency as built: ngspice on the emitted netlist, the stage on the drive it found.
struct AsBuilt {
  Hertz frequency;
  tracking::TrackingError error;
  tracking::TrackingError without;        ///< no controller: v = r
  double cvode_difference_percent = 0.0;  ///< rms of v in time against CVODE on the netlist, percent of range
  double start_up_percent = 0.0;  ///< rms of v in the first repeat, from rest, against the settled one
  double wall_s = 0.0;            ///< of ngspice
};

std::vector<AsBuilt> measure_as_built(const DisturbanceCircuit& controller,
                                      const std::vector<Hertz>& frequencies,
                                      const tracking::Reference& reference = tracking::Reference());
/// Without ngspice: the same chain in CVODE, at every tracked frequency.
std::vector<AsBuilt> predict_as_built(const DisturbanceCircuit& controller,
                                      const tracking::Reference& reference);
/// The worst rms without lag; 0 for none.
double worst_percent(const std::vector<AsBuilt>& cases);

Json to_json(const std::vector<AsBuilt>& cases);

}  // namespace bodesmith::generator
