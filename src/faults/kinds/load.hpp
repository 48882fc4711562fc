#pragma once

#include <functional>
#include <string>
#include <vector>

#include "faults/circuit_board.hpp"

namespace bodesmith::faults {

/// A load between a node and ground whose size is exp(t).
struct Load {
  double least = 0.0;  ///< exp(t) lies between these beforehand
  double most = 0.0;
  /// Its stamp at a node, of exp(t).
  std::function<Stamp(const CircuitBoard& board, const std::string& node, double value)> stamp;
  std::string unit;  ///< for a person
  std::string key;   ///< for files
  std::string words_end;
  /// What to do about it, of "the output" or "node n1".
  std::function<std::string(const std::string& where)> rework;
};

/// One at every node of the board, the output among them.
std::vector<Fault> load_faults(const CircuitBoard& board, const Load& load);

}  // namespace bodesmith::faults
