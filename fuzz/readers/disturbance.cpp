#include "signal/disturbance.hpp"
#include "base/documents/document.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_disturbance_bytes(std::string_view bytes) {
  const Disturbance d = Disturbance::from_node(parse_json(bytes, "disturbance.json"));
  require_finite(d.value(Disturbance::Branch::ascending, 0.5));
  require_finite(d.rate_gain(Disturbance::Branch::descending, Hertz{15.0}));
}
const Registered disturbance_reader{"disturbance", read_disturbance_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
