#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tolerance/controller/study.hpp"

namespace bodesmith::tolerance {

/// A potentiometer that the circuit has room for.
struct Trim {
  std::string name;           ///< "offset of M2"
  std::string how;            ///< where it goes and what it is made of
  std::string unit;           ///< of its setting: "V", or "" for a relative change
  double unit_setting = 0.0;  ///< what one thousandth of its usual range is, about
  double limit = 0.0;         ///< of the setting, either side: more is not to be had this way
  std::function<void(generator::Copy&, double setting)> apply;
};
/// Every trim of a controller, the usual ones first.
std::vector<Trim> trims_of(const generator::DisturbanceCircuit& controller);

/// Something that is measured on the bench with a voltmeter.
struct Reading {
  enum class Kind {
    rising,      ///< v at rest after a slow approach from below
    falling,     ///< the same from above
    mean,        ///< of both
    difference,  ///< rising less falling
    slope,       ///< mean of the slope meter's voltage while the fastest tracked triangle runs
  };
  Kind kind = Kind::mean;
  double r = 0.0;  ///< V
  std::string words(const generator::DisturbanceCircuit& controller, Hertz fastest) const;
};
double read(const Reading& reading, const Board& board, const Input& fastest);

struct TrimOptions {
  int trims = 3;                     ///< at most
  int rounds = 2;                    ///< so often all steps are gone through
  int turns = 3;                     ///< adjustments within a step, at most
  double reading_noise_v = 2e-4;     ///< rms, of each reading
  double setting_resolution = 1e-3;  ///< of a potentiometer's range
  std::uint64_t draws = 1000;
};

/// One step: turn this until that reads so much.
struct TrimStep {
  Trim trim;
  Reading reading;
  double expected_v = 0.0;  ///< of the design as it should be
  double volts_per_setting = 0.0;
  double range = 0.0;  ///< of the setting, either side
};

struct TrimStudy {
  std::vector<TrimStep> steps;
  int rounds = 0;
  std::vector<ErrorSpread> before_at, after_at;  ///< each frequency
  ErrorSpread before, after;                     ///< worst frequency of each copy
  /// What is left of the mean square when a trim is added, as foreseen: none, the first, the first two, …
  std::vector<double> foreseen_share;
};

/// Chooses trims, readings and order by the linear model of all causes: the least mean square of the tracking
/// error that is left when the readings are what they should be. Then trims every copy that `options` draws,
/// blind: whoever turns knows the design's expected readings and sees noisy ones of the copy. `untrimmed`: what
/// study_errors() found of the same copies, where that is known.
TrimStudy study_trims(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
                      const StudyOptions& options, const TrimOptions& trims,
                      const Study* untrimmed = nullptr);

}  // namespace bodesmith::tolerance
