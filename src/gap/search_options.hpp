#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "gap/effect.hpp"

namespace bodesmith::gap {

// The limits of each step of a search. The numbers in brackets are the steps of docs/gap.md that explain
// them.

/// Long records are first fitted on the stretches of which most is left [5].
struct StretchOptions {
  std::size_t samples = 8000;  ///< of all stretches together; one and a half times as many: long records
};

/// Rounds of candidates [4, 5].
struct RoundOptions {
  std::size_t effects = 9;  ///< fitted in each round
  std::size_t places = 3;   ///< and forms of each
  std::size_t pairs =
      20;  ///< fitted, of what each effect promises alongside each of as many first names as a round fits
  std::size_t followed =
      3;  ///< of the starts of each, of pairs, and of fits that saw only stretches: the best so many are gone on from
  std::size_t many_unknowns = 5;  ///< a term of so many is tried from one start, and may stand for two others
  double far_behind =
      3.0;  ///< times the leader's rms, once all have begun: such a fit stays where it is, and its evidence is not asked for
};

/// What takes less is of no use, however sure it is [4].
struct BoundOptions {
  /// Of the rms, what a name explains: of the geometric mean of what is left without it and of the gap that the base model
  /// leaves. Of the former alone false names would explain half of the little that a form leaves; of the latter alone a small
  /// effect next to a large one would have no name.
  double explained = 0.15;
  /// Share of the residual's energy that a proposal must promise to be fitted: half of what it must take in the end.
  double min_promise() const { return 0.5 * explained * explained; }
};

/// What the drive of experiment.csv may be, as far as somebody says it; the rest is taken from the training records.
struct DriveRequest {
  std::optional<double> lower;
  std::optional<double> upper;
  std::optional<double> max_rate;  ///< per second
  std::optional<double> duration_s;
  std::optional<double> step_s;

  static constexpr double kMostSamples = 20000.0;
};

struct SearchOptions {
  int max_terms = 5;
  int iterations = 40;  ///< of a fit
  int few_iterations =
      3;  ///< of each start of a candidate before the best ones go on, and on whole records after stretches
  int threads = 2;
  std::function<void(double)> progress;  ///< fraction of the work, roughly
  std::function<bool()> stop;            ///< true: keep the best so far and return
  std::function<bool()> late;            ///< true: judge what has been fitted, and begin nothing new

  /// A record began in another state than rest where the rms of its start's residual is so many times that of the rest [2].
  double start_stands_out = 1.35;
  /// So many times the rms is left where something contradicts what was found: held-out records, or starts that were left out.
  double contradicts = 2.0;
  StretchOptions stretches;
  RoundOptions round;
  BoundOptions bounds;
  DriveRequest drive;  ///< what experiment.csv may be

  bool stopped() const { return stop && stop(); }
  bool is_late() const { return stopped() || (late && late()); }
  void report(double fraction) const {
    if (progress) progress(fraction);
  }
};

}  // namespace bodesmith::gap
