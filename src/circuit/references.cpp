#include "circuit/references.hpp"

namespace bodesmith::circuit {

std::vector<std::string> part_references(const Circuit& circuit) {
  ReferenceCounter counter;
  std::vector<std::string> out;
  for (const Part& part : circuit.parts)
    out.push_back(counter.next(part.kind == Part::Kind::resistor ? "R" : "C"));
  return out;
}

}  // namespace bodesmith::circuit
