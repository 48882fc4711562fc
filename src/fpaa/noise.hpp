#pragma once

#include <vector>

#include "fpaa/plan.hpp"

namespace bodesmith::fpaa {

/// A place where switched capacitors bring noise charge into a CAM.
struct NoiseCharge {
  double units = 0.0;   ///< sum of the switched capacitors there
  ZTransfer to_output;  ///< volts at the CAM's output per unit of charge (V C_u)
};

/// The noise charges of a CAM of known topology (FilterBilinear, FilterBiquad, GainInv); empty for others.
std::vector<NoiseCharge> noise_charges(const PlacedCam& cam);

}  // namespace bodesmith::fpaa
