#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "gap/effect.hpp"
#include "gap/noise_floor.hpp"
#include "gap/signs.hpp"

namespace bodesmith::gap {

/// What became of a candidate of a round.
enum class CandidateOutcome {
  not_judged,
  named,
  named_in_pair,  ///< earns its place only together with the candidate that the next round names
  tied,           ///< as good a name as the one that was chosen
  also_fits_with_more_unknowns,
  other_place_or_form,  ///< of the effect that was named
  worse,
  no_gain_on_folds,
  not_significant,
  too_free,  ///< for a study without another excitation held out
  ill_conditioned,
  at_end_of_range,
  no_name,
};
/// As in diagnosis.json and on the page; empty for not_judged.
std::string to_string(CandidateOutcome outcome);

/// One candidate of a round, fitted.
struct Ranked {
  const Effect* effect = nullptr;
  std::string placed;
  Model model;
  double score = 0.0;  ///< share of the residual's energy that the shortlist predicted
  double train_rms = std::numeric_limits<double>::infinity();
  /// On folds of the training records (search/folds.hpp); of candidates far behind as on all of them.
  double folds_rms = std::numeric_limits<double>::infinity();
  double z = 0.0;  ///< standard deviations of its gain on the folds
  double train_z = 0.0;
  std::vector<double> folds = {};  ///< residuals; empty for candidates far behind
  /// Of the held-out records: looked at when all is decided, for the report.
  double holdout_rms = std::numeric_limits<double>::infinity();
  double condition_number = 0.0;
  std::size_t unknowns = 0;
  std::size_t effective = 0;  ///< of them not at a bound: weights of 0 cost nothing
  bool far_fetched = false;   ///< Effect::is_far_fetched
  bool no_name = false;       ///< Effect::is_no_name
  CandidateOutcome outcome = CandidateOutcome::not_judged;

  double least_z() const { return std::min(z, train_z); }
};

/// One term that was found.
struct Step {
  const Effect* effect = nullptr;
  std::vector<std::string> tied_with;
  std::vector<std::string> also_fit;  ///< rivals with more parameters that do no better
  std::string placed;
  std::vector<std::string> also_placed;  ///< other places at which the same effect fits as well
  Model before;
  Model after;
  std::vector<Ranked> ranking;
  std::string pair_with;  ///< the effect with which it earns its place together; empty: it does so alone
  double q_value = 1.0;   ///< share of false names to expect among those as significant
};

struct SearchResult {
  Model initial;  ///< as given
  Model base;     ///< free parameters refitted, nothing added
  Model final;
  std::vector<Step> steps;
  std::vector<Ranked> refused;  ///< the ranking of the round in which nothing earned its place
  std::vector<Sign> structure;  ///< what still points to something missing
  NoiseFloor floor;
  double train_rms = 0.0;  ///< of the final model, over what the search scored
  bool stopped = false;
  bool late = false;                   ///< the time was over before the search had ended
  std::vector<std::string> not_tried;  ///< effects for which the time was too short
  std::size_t looked_at = 0;           ///< proposals of all rounds
  std::vector<std::string> notes;
};

}  // namespace bodesmith::gap
