#pragma once

#include <string>
#include <vector>

#include "project/design/design.hpp"

namespace bodesmith::project {

/// What a stage adds to the error, and what has accumulated so far.
struct BudgetRow {
  std::string stage;
  std::string previous;                 ///< the stage it is compared with; empty for the first
  ResponseDifference against_previous;  ///< over the band; zero for the cascade
  double points_max_db = 0.0;           ///< largest error at the target points
  WaveformError waveform;  ///< compensating waveform at the tracked frequencies, percent of range
};

/// The error of every stage, in terms of the response and of the compensating waveform.
struct Budget {
  Band band;
  std::vector<BudgetRow> rows;
  WaveformError uncompensated;  ///< no rate compensation: gain 1 at every frequency
  WaveformError constant;       ///< the best single gain
  double constant_gain = 1.0;
  /// The cascade's magnitude fits, and yet its waveform is worse than with no rate compensation at all.
  bool magnitude_only_is_worse = false;
};
/// `other`: that of the same fit with another alternative, whose figures of the cascade and of gains alone are taken.
Budget make_budget(const Project& project, const Design& design, const Budget* other = nullptr);

/// Frequencies for tables and plots of the stages: a decade beyond the design's band on either side, an octave where nothing else
/// than the target's band was asked for.
std::vector<Hertz> stages_grid(const Project& project, const Design& design);
/// The Bode plot of all stages with the target points, and beneath it how far they are apart.
std::vector<report::Plot> stages_plots(const Project& project, const Design& design);

/// What an alternative becomes when it is built: for a reader who would choose another one than the run did.
struct AlternativeStudy {
  Design
      design;  ///< the run's with this alternative chosen, and its own plan and circuit where they can be made
  Budget budget;
  std::vector<std::string> refused;  ///< why board or parts cannot make it
};

/// One for every alternative, in their order. The one that the run builds, of which `budget` is, is not made anew.
std::vector<AlternativeStudy> study_alternatives(const Project& project, const Design& design,
                                                 const Budget& budget, AlternativeHardware& hardware);

}  // namespace bodesmith::project
