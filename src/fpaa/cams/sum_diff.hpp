#pragma once

#include <vector>

#include "fpaa/z_transfer.hpp"

namespace bodesmith::fpaa {

/// CAM SumDiff with 2 to 4 inputs: Vout = sum of +-Ci/Cout Vi. Inverting inputs pass without delay, the
/// others half a cycle late; the output is valid for half a cycle. One capacitor an input and Cout; one
/// op-amp.
struct SumDiff {
  struct Input {
    int units = 1;
    bool inverting = false;
  };
  std::vector<Input> inputs;
  int cout = 1;

  ZTransfer transfer(std::size_t input) const;
  double delay_cycles(std::size_t input) const { return inputs.at(input).inverting ? 0.0 : 0.5; }
  int capacitors() const { return static_cast<int>(inputs.size()) + 1; }

  /// The integers that make the gains (their signs tell which inputs invert) with the least worst error
  /// relative to the largest gain; exhaustive over Cout.
  static SumDiff best(const std::vector<double>& gains, int largest = 255);
};

}  // namespace bodesmith::fpaa
