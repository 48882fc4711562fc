#pragma once

#include <cstddef>
#include <vector>

#include "fpaa/cams/cam_values.hpp"
#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

class Cam;

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

  /// The integers that make the gains (their signs tell which inputs invert) with the smallest worst error
  /// relative to the largest gain; exhaustive over Cout.
  static SumDiff best(const std::vector<double>& gains, int max_capacitor = 255);
};

/// What the dialog asks for: one gain an input, negative for one that inverts.
struct SumDiffSpec {
  std::vector<double> gains;

  std::string option() const;
  CamValues values() const;
};

const Cam& sum_diff_cam();

}  // namespace bodesmith::fpaa
