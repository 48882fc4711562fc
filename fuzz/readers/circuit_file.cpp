#include "synthesis/circuit_file.hpp"
#include "base/documents/document.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_circuit_bytes(std::string_view bytes) {
  const auto file = synthesis::CircuitFile::from_node(parse_json(bytes, "circuit.json"));
  for (const auto& part : file.circuit.parts) require_finite(part.realised);
}
const Registered circuit_reader{"circuit_file", read_circuit_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
