#pragma once

#include <string>
#include <vector>

#include "base/units.hpp"
#include "tracking/reference.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::tracking {

/// The drive that a controller makes, in steady state: 1 is full stroke.
struct DriveWaveform {
  std::vector<double> v;  ///< evenly sampled over whole repeats of the reference, from its phase 0 on
  double step_s = 0.0;
  DriveKind kind = DriveKind::smooth;
  std::vector<std::string> clipped = {};  ///< blocks of it that clipped on the way
};

/// A controller as it is built: an analog circuit run in ngspice, a board worked out tick by tick. A study asks it
/// for the drive at every tracked frequency and gives that to a Stage; nothing else of it is known.
class BuiltController {
 public:
  BuiltController() = default;
  BuiltController(const BuiltController&) = delete;
  BuiltController& operator=(const BuiltController&) = delete;
  virtual ~BuiltController() = default;

  /// Column of tracking.csv without its unit and key in run.json: letters, digits and underscores,
  /// "controller_circuit".
  virtual std::string key() const = 0;
  virtual std::string name() const = 0;  ///< for a person: "analog controller (ngspice)"
  /// How much there is to build; of two controllers that track alike the one with fewer is taken.
  virtual int part_count() const = 0;
  /// One repeat of the reference lasts reference.periods()/operating. DesignError when it cannot be run.
  virtual DriveWaveform drive(const Reference& reference, Hertz operating) const = 0;
};

}  // namespace bodesmith::tracking
