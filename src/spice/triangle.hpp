#pragma once

#include <string>

namespace bodesmith::spice {

/// Two periods of a triangle of 0 to 1 V as the points of a PWL source.
std::string triangle_points(double frequency_hz);

}  // namespace bodesmith::spice
