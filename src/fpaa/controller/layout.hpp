#pragma once

#include "fpaa/controller/controller.hpp"

namespace bodesmith::fpaa {

/// The whole controller with its polynomials made in one way, in one structure: every CAM in signal order
/// with its capacitors and its place, what stands outside, the I/O cells it needs, its delay and its error.
/// Where it does not fit on the board or cannot work, the variant says so.
ControllerVariant laid_out(PolynomialBy by, ControllerStructure structure, const Disturbance& disturbance,
                           const Plan* ascending, const Plan* descending, const ControllerOptions& options);

}  // namespace bodesmith::fpaa
