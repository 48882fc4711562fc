#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "identify/stage_lag.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::identify {

using hysteresis::GainReading;

/// Ascending, descending.
using BranchPair = std::array<double, 2>;

/// The loop at one frequency of full strokes.
struct LoopAtFrequency {
  std::string file;
  Hertz frequency;
  double offset = 0.0;                                ///< y under x = 0
  double stroke = 0.0;                                ///< y's change over the full stroke, with its sign
  double stroke_deviation = 0.0;                      ///< its standard deviation
  std::array<std::array<double, 3>, 2> polynomial{};  ///< of its own
  BranchPair gain{1.0, 1.0};                          ///< K, p_i ≈ K p_1
  BranchPair deviation{};                             ///< standard deviation of K, that of p_1's size with it
  BranchPair as_printed{1.0, 1.0};                    ///< eq. 13 as printed, p_1 ≈ K p_i
  std::size_t training_turns = 0;
  std::size_t held_out_turns = 0;
  /// RMS over the held-out turns in percent of the stroke (over the training turns where none are held out).
  double own_percent = 0.0;         ///< of its own polynomials
  double gain_percent = 0.0;        ///< of the base polynomials times `gain`
  double as_printed_percent = 0.0;  ///< times `as_printed`
};

/// The loop of a short stroke.
struct LoopAtStroke {
  double alpha = 0.0;  ///< of the full stroke
  BranchPair gain{};   ///< α_1, α_2
  BranchPair deviation{};
  double slope = 1.0;  ///< of y over x from end to end, of that of the full stroke
  double line_percent =
      0.0;  ///< rms of y against the equation below with the full stroke's offset and stroke, in percent of that
  std::size_t turns = 0;
};

/// What the records say of the stage
///   y(t) = offset + stroke (x + α_b(α) K_b(f) p_b(x/α))(t − lag),   x = input(u) in [0, 1],
/// branch b by the direction of x, p_b a cubic with zero ends (disturbance paper, eq. 1-5, 11-13): in the stage's own
/// sign, so that v = r − K d(v) is its inverse.
struct StageDisturbance {
  Disturbance disturbance;  ///< with the gains of `reading`, and those that cannot be told from 1 as 1
  GainReading reading = GainReading::basis_times_gain;
  StageLag lag;
  Scaling input;
  std::vector<LoopAtFrequency> loops;  ///< by frequency, the base first
  std::vector<LoopAtStroke> strokes;   ///< by stroke
  BranchPair static_sigma{};           ///< largest |K − 1| of a branch in deviations
  std::vector<std::string> notes;

  /// The branch whose gains vary most, against their deviations.
  Disturbance::Branch varying() const;
  const BranchPair& gain(const LoopAtFrequency& loop) const {
    return reading == GainReading::as_printed ? loop.as_printed : loop.gain;
  }
  /// `disturbance` and next to it, under "identified", everything above.
  Json to_json() const;
  /// frequency_hz,gain of the varying branch.
  std::string gains_csv() const;
};

/// Of full-stroke records at one frequency each, and where there are any of shorter strokes. Every second turn is held out
/// (the fit never sees it). `reading`: how eq. 11-13 are read; nothing: the better one on the held-out turns. Throws
/// InputError naming the record where signs do not fit: an output that falls in one record and rises in another, a loop
/// that runs the other way.
StageDisturbance identify_disturbance(std::span<const TimeRecord> records,
                                      std::optional<GainReading> reading = std::nullopt);

}  // namespace bodesmith::identify
