#pragma once

#include <map>
#include <string>
#include <vector>

#include "circuit/circuit.hpp"

namespace bodesmith::circuit {

/// References as a board's drawing and its parts list number them (IEEE 315): the letter of the kind, then the
/// part's place among its kind: R1, R2, C1, D1, U1.
class ReferenceCounter {
 public:
  std::string next(const std::string& letter) { return letter + std::to_string(++count_[letter]); }

 private:
  std::map<std::string, int> count_;
};

/// Of Circuit::parts, one by one in their order.
std::vector<std::string> part_references(const Circuit& circuit);

}  // namespace bodesmith::circuit
