#pragma once

#include <map>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// References as a board's drawing and its parts list number them (IEEE 315): the letter of the kind, then the
/// part's place among its kind: R1, R2, C1, D1, U1.
class ReferenceCounter {
 public:
  std::string next(const std::string& letter) { return letter + std::to_string(++count_[letter]); }

 private:
  std::map<std::string, int> count_;
};

/// Of Netlist::parts, one by one in their order.
inline std::vector<std::string> part_references(const Netlist& netlist, ReferenceCounter& counter) {
  std::vector<std::string> out;
  for (const Part& part : netlist.parts)
    out.push_back(counter.next(part.kind == Part::Kind::resistor    ? "R"
                               : part.kind == Part::Kind::capacitor ? "C"
                                                                    : "D"));
  return out;
}

}  // namespace bodesmith::schematic
