#pragma once

#include <vector>

#include "controller/controller.hpp"

namespace bodesmith::controller {

/// Between two frequencies of the table the gain is linear in ln f; straight pieces over f take its place, as
/// many as keep |K - table| |d| below the tolerance (percent of range). `peak`: greatest |d| of the branches.
RateCurve make_rate_curve(const Disturbance& disturbance, const double peak[2],
                          const std::vector<Hertz>& tracked, double tolerance_percent);

}  // namespace bodesmith::controller
