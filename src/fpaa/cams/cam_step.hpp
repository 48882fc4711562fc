#pragma once

#include <span>

namespace bodesmith::fpaa {

/// A CAM whose insides are not switched capacitors alone (a converter, a comparator) at work: what the edges of its clock
/// make of its inputs, one after another, in volts. All it remembers starts at 0. Logic is 0 or 1.
class CamStep {
 public:
  CamStep() = default;
  CamStep(const CamStep&) = delete;
  CamStep& operator=(const CamStep&) = delete;
  virtual ~CamStep() = default;

  /// The output that this edge makes of the inputs (input 1 first), before any delay.
  virtual double at_edge(std::span<const double> inputs) = 0;
};

}  // namespace bodesmith::fpaa
