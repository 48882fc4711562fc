#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "hysteresis/model_type.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::identify {

using hysteresis::Scaling;

/// The input from its lowest value up and back down: samples first … top … last.
struct Turn {
  std::size_t first = 0;
  std::size_t top = 0;
  std::size_t last = 0;
  double low = 0.0;   ///< of the input, at both ends
  double high = 0.0;  ///< at the top
};

/// A record of a drive that goes up and down at one frequency.
struct TurnedRecord {
  const TimeRecord* record = nullptr;
  Hertz frequency;
  std::vector<Turn> training;  ///< of the full stroke
  std::vector<Turn> held_out;  ///< of the full stroke, every second one
  std::vector<Turn> partial;   ///< of less than 97 % of it
};

/// Records of one stage, and the input's full stroke in all of them.
struct TurnedRecords {
  std::vector<TurnedRecord> all;
  Scaling input;  ///< x = input(u), 0 … 1 over the full stroke
};

/// Turns begin and end at one level (within 3 % of their height); what comes before the first and after the last is left
/// out. Of three turns or more at one height the first is left out too: a stage that starts at rest comes up another way.
/// The frequency is that of the turns, rounded to three digits where the sampling cannot tell the difference. Throws
/// InputError naming the record when there is no turn in it, or when its turns differ in length by more than 5 %.
TurnedRecords cut_into_turns(std::span<const TimeRecord> records);

/// What makes a stage late, apart from its loop.
struct StageLag {
  enum class Kind {
    none,
    delay,      ///< a pure delay
    sensor,     ///< 1/(1 + seconds s) behind the stage
    amplifier,  ///< 1/(1 + seconds s) in front of it
  };
  Kind kind = Kind::none;
  double seconds = 0.0;
  double deviation_s = 0.0;  ///< standard deviation
};
constexpr std::string_view to_string(StageLag::Kind kind) {
  return kind == StageLag::Kind::delay       ? "delay"
         : kind == StageLag::Kind::sensor    ? "pole behind the stage"
         : kind == StageLag::Kind::amplifier ? "pole in front of the stage"
                                             : "none";
}

/// Two cubics in x from which a branch's disturbance is made, coefficients of x, x², x³.
using ShapePair = std::array<std::array<double, 3>, 2>;
/// x − x³ and x² − x³: all cubics that are 0 at 0 and 1 (disturbance paper, eq. 3).
inline constexpr ShapePair kZeroEnds{{{1.0, 0.0, -1.0}, {0.0, 1.0, -1.0}}};

/// The columns of a record's linear model y = Σ c_k column_k, one row a sample, late by the lag:
///   1, x, the ascending shapes (0 while x falls), the descending shapes (0 while it rises), time about its mean (a drift)
/// with x = (input(u) − origin)/stroke.
struct StageColumns {
  static constexpr Eigen::Index kCount = 7;
  ShapePair ascending = kZeroEnds;
  ShapePair descending = kZeroEnds;
  double origin = 0.0;
  double stroke = 1.0;

  Eigen::MatrixXd of(const TurnedRecord& record, const Scaling& input, const StageLag& lag) const;
};

/// c by least squares over the samples of some turns, and how sure they are.
struct StageSolution {
  Eigen::VectorXd c;
  Eigen::VectorXd deviation;
  double squares = 0.0;  ///< of the residual
  std::size_t samples = 0;

  /// RMS of y − (columns · values) over some turns.
  static double rms(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values, const TimeRecord& record,
                    std::span<const Turn> turns);
};
/// A drift is told from a loop by a second turn only: with one it is left out.
StageSolution solve_stage(const Eigen::MatrixXd& columns, const TimeRecord& record,
                          std::span<const Turn> turns);

/// The lag that all records have in common, each with polynomials of its own: a lag moves the corners of the output, a
/// loop does not. Of the three kinds the one that leaves least, none where it is less than three deviations. Up to a tenth
/// of the shortest period.
StageLag find_lag(const TurnedRecords& records);

}  // namespace bodesmith::identify
