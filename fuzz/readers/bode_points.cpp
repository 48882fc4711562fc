#include "signal/bode_points.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_points_bytes(std::string_view bytes) {
  Provenance from;
  for (const BodePoint& point : BodePoints::read_csv(as_file(bytes, "points.csv"), from).points) {
    require_finite(point.frequency.value);
    require_finite(point.gain);
  }
}
const Registered points_reader{"bode_points", read_points_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
