#include "faults/kinds/part_words.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace bodesmith::faults {

std::string value_text(const schematic::Part& part, double value) {
  return engineering_text(value, part.kind == schematic::Part::Kind::resistor ? "Ω" : "F");
}

std::string value_key(const schematic::Part& part) {
  return part.kind == schematic::Part::Kind::resistor ? "value_ohm" : "value_f";
}

Fault fault_of_part(const CircuitBoard& board, std::size_t part) {
  const schematic::Part& p = board.circuit().parts[part];
  Fault out = Fault::of(p.name);
  out.rework = fmt::format("replace {} by {}", p.name, value_text(p, p.realised));
  out.replaces = {part};
  return out;
}

}  // namespace bodesmith::faults
