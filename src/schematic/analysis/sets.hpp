#pragma once

#include <numeric>
#include <vector>

namespace bodesmith::schematic {

/// Sets that grow together: nodes that something joins.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int one) {
    while (parent(one) != one) one = parent(one) = parent(parent(one));
    return one;
  }
  void join(int a, int b) { parent(of(a)) = of(b); }

 private:
  int& parent(int one) { return parent_[static_cast<std::size_t>(one)]; }
  std::vector<int> parent_;
};

}  // namespace bodesmith::schematic
