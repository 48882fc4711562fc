#pragma once

#include "fpaa/controller.hpp"

namespace bodesmith::fpaa {

/// The whole controller with its polynomials made in one way: every CAM in signal order with its place, the
/// I/O cells it needs, its delay and its error. Where it does not fit on the board, the variant says so.
ControllerVariant laid_out(PolynomialBy by, const Disturbance& disturbance, const Plan* ascending,
                           const Plan* descending, const ControllerOptions& options);

}  // namespace bodesmith::fpaa
