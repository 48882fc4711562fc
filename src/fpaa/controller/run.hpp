#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fpaa/controller/controller.hpp"
#include "fpaa/plan/board_run.hpp"

namespace bodesmith::fpaa {

/// What the controller has to follow: shares of the stroke over time, periodic or not, also before t = 0.
struct ControllerReference {
  std::function<double(double time_s)> x;
  std::function<bool(double time_s)> rises;  ///< for a switch outside, which a reference generator drives
};

/// A controller at work, by its switches (BoardRun), from rest some time before t = 0 until it has
/// settled.
class ControllerRun {
 public:
  /// `variant` with the capacitors of the operating frequency (ControllerVariant::at). All times are those at
  /// which the drive is there.
  ControllerRun(const ControllerVariant& variant, const ControllerReference& reference);

  /// The drive, share of the stroke, at a time >= 0 that is not before the last one. Where the last one is long ago it has
  /// settled in between: that is passed over.
  double drive(double time_s);
  /// CAMs that clipped since t = 0, the slope detector's (which may) left out.
  std::vector<std::string> clipped() const;

 private:
  double settling_s_, last_s_ = 0.0;
  VoltScale scale_;
  std::string drive_;
  std::unique_ptr<BoardRun> simulation_;
};

}  // namespace bodesmith::fpaa
