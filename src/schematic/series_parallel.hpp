#pragma once

#include <set>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// Parts between two nodes, as far as they are series and parallel connections of each other.
struct Branch {
  enum class Kind { part, series, parallel };
  Kind kind = Kind::part;
  size_t part = 0;               ///< index in the list given to series_parallel_branches()
  std::vector<Branch> children;  ///< series: from left to right
  std::string left;
  std::string right;

  bool joins(const std::string& a, const std::string& b) const {
    return (left == a && right == b) || (left == b && right == a);
  }
  bool ends_at(const std::string& node) const { return left == node || right == node; }
  const std::string& other_end(const std::string& node) const { return left == node ? right : left; }
  /// The same with `node` on the left.
  Branch from(const std::string& node) const;
};

/// Reduces a network: parts between the same two nodes become parallel, two branches that meet alone at a
/// node which is not in `kept` become one in series, until nothing changes. What stays between is what a
/// drawing has to place (a resistor, R||C, R + C, a whole Cauer ladder).
std::vector<Branch> series_parallel_branches(const std::vector<Part>& parts,
                                             const std::set<std::string>& kept);

}  // namespace bodesmith::schematic
