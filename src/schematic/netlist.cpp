#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

const Part* Netlist::part_named(const std::string& name) const {
  const auto at = std::find_if(parts.begin(), parts.end(), [&](const Part& one) { return one.name == name; });
  return at == parts.end() ? nullptr : &*at;
}

}  // namespace bodesmith::schematic
