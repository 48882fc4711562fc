#pragma once

#include <cstddef>
#include <functional>
#include <optional>

namespace bodesmith::gap {

// The limits of each step of a search. The numbers in brackets are the steps of docs/gap.md that explain
// them.

/// Long records are first fitted on the stretches of which most is left [5]: samples of all of them together; one and a half times as many
/// are long. A drive of experiment.csv has as many at most.
inline constexpr std::size_t kStretchSamples = 8000;

// Rounds of candidates [4, 5].
/// Effects that are fitted in each round, and first names that pairs are looked for alongside; of pairs twice as many.
inline constexpr std::size_t kEffectsOfRound = 9;
/// At first: places and forms of each effect, starts of each, iterations from these and on whole records after stretches, pairs, and fits on
/// whole records. The best are gone on from. A term of more unknowns may stand for two others; one of twice as many is tried from one start.
inline constexpr std::size_t kFew = 3;
/// Times the rms, far more is left: held-out records, or starts that were left out, contradict what was found. A fit that came by so much
/// nearer is done again in the unit of what is left now. One that is so far behind the leader once all have begun stays where it is, and
/// its evidence is not asked for. A response that changes so much more at its peak than next to it, or at the top of its band, changes there.
inline constexpr double kFarMore = 2.0;

/// Of the rms, what a name explains, however sure it is [4]: of the geometric mean of what is left without it and of the gap that the base
/// model leaves. Of the former alone false names would explain half of the little that a form leaves; of the latter alone a small
/// effect next to a large one would have no name.
inline constexpr double kExplained = 0.15;
/// Of the energy: what a sign must hold, too.
inline constexpr double kLeastShare = kExplained * kExplained;

/// What the drive of experiment.csv may be, as far as somebody says it; the rest is taken from the training records.
struct DriveRequest {
  std::optional<double> lower;
  std::optional<double> upper;
  std::optional<double> max_rate;  ///< per second
  std::optional<double> duration_s;
  std::optional<double> step_s;
};

struct SearchOptions {
  int max_terms = 5;
  int threads = 2;
  std::function<void(double)> progress;  ///< fraction of the work, roughly
  std::function<bool()> stop;            ///< true: keep the best so far and return
  std::function<bool()> late;            ///< true: judge what has been fitted, and begin nothing new

  DriveRequest drive;  ///< what experiment.csv may be

  bool stopped() const { return stop && stop(); }
  bool is_late() const { return stopped() || (late && late()); }
  void report(double fraction) const {
    if (progress) progress(fraction);
  }
};

}  // namespace bodesmith::gap
