#pragma once

#include <span>
#include <vector>

#include "fpaa/cams/placed_cam.hpp"

namespace bodesmith::fpaa {

/// A CAM at work: what the edges of its clock make of its inputs, one after another, in volts. All it
/// remembers starts at 0. Logic is 0 or 1.
class CamStep {
 public:
  CamStep() = default;
  CamStep(const CamStep&) = delete;
  CamStep& operator=(const CamStep&) = delete;
  virtual ~CamStep() = default;

  /// The output that this edge makes of the inputs (input 1 first), before any delay.
  virtual double at_edge(std::span<const double> inputs) = 0;
};

/// a0 y[n] = sum over inputs and p of b_p x[n-p] - sum over p > 0 of a_p y[n-p], from PlacedCam::z.
class LinearStep final : public CamStep {
 public:
  explicit LinearStep(const PlacedCam& cam);
  double at_edge(std::span<const double> inputs) override;

 private:
  struct Tap {
    std::vector<double> above;    ///< b0, b1, …, over a0
    std::vector<double> history;  ///< x[n-1], x[n-2], …
  };
  std::vector<Tap> taps_;
  std::vector<double> below_;  ///< a1, a2, …, over a0
  std::vector<double> outputs_;
};

}  // namespace bodesmith::fpaa
