#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hysteresis/everett_trace.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

/// Relay weights by non-negative least squares, min Σ (y − offset − Σ w R[u])², w ≥ 0, on the whole plane of
/// L (L + 1)/2 relays. The system is never formed: products with it run over the stack's trace
/// (EverettTrace), the plane is refined from coarse to fine (…, L/4, L/2, L), and each plane is solved by
/// MPRGP (non_negative_least_squares()).
struct PreisachWeights {
  std::vector<double> weights;
  double offset = 0.0;
  double rms = 0.0;
  double kkt = 0.0;  ///< length of the projected gradient against that of Aᵀy
  int iterations = 0;
  bool converged = false;
  std::size_t active = 0;  ///< weights above 0
  std::size_t unseen = 0;  ///< relays that never (or always) stand on in the counted samples
};
PreisachWeights fit_preisach_weights(std::span<const TimeRecord> records, double skip_s, double u_min,
                                     double u_max, std::size_t levels, CellShape shape,
                                     int iterations = 3000);

}  // namespace bodesmith::hysteresis
