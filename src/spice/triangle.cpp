#include "spice/triangle.hpp"

#include <fmt/format.h>

namespace bodesmith::spice {

std::string triangle_points(double frequency_hz) {
  std::string out = "0 0";
  for (int half = 1; half <= 4; ++half)
    out += fmt::format(" {:.12g} {}", half / (2.0 * frequency_hz), half % 2);
  return out;
}

}  // namespace bodesmith::spice
