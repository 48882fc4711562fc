#include "base/documents/document.hpp"
#include "reader.hpp"
#include "synthesis/generator/circuit.hpp"

namespace bodesmith::fuzz {
namespace {

void read_layout_bytes(std::string_view bytes) {
  const auto input = generator::Input::from_node(parse_json(bytes, "disturbance.json"));
  for (const double alpha : input.alpha) require_finite(alpha);
}
const Registered layout_reader{"layout_input", read_layout_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
