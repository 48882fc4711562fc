#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "gap/effect.hpp"
#include "gap/evidence/noise_floor.hpp"
#include "gap/signs/signs.hpp"

namespace bodesmith::gap {

/// What became of a candidate of a round.
enum class CandidateOutcome {
  not_judged,
  named,
  tied,                 ///< as good a name as the one that was chosen
  other_place_or_form,  ///< of the effect that was named
  worse,
  takes_too_little,  ///< of the gap, or of what is left without it
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
  /// Of the held-out records: looked at when all is decided, for the report.
  double holdout_rms = std::numeric_limits<double>::infinity();
  /// Of its model (evidence/score.hpp); minus infinity for those far behind.
  double log_evidence = -std::numeric_limits<double>::infinity();
  CandidateOutcome outcome = CandidateOutcome::not_judged;
};

/// One term that was found.
struct Step {
  const Effect* effect = nullptr;
  std::vector<std::string> tied_with;
  std::string placed;
  std::vector<std::string> also_placed;  ///< other places at which the same effect fits as well
  Model after;
  std::vector<Ranked> ranking;
  double log_evidence_without = 0.0;  ///< of the model that the ranking's candidates were put into
};

struct SearchResult {
  Model initial;  ///< as given
  Model base;     ///< free parameters refitted, nothing added
  Model final;
  std::vector<Step> steps;
  std::vector<Ranked> refused;  ///< the ranking of the round in which nothing earned its place
  std::vector<Sign> structure;  ///< what still points to something missing
  NoiseFloor floor;
  std::size_t holds = 1;      ///< of the engine to a sample (TimeExperiment::set_holds) in what follows
  double train_rms = 0.0;     ///< of the final model, over what the search scored
  double log_evidence = 0.0;  ///< of it there
  bool stopped = false;
  bool late = false;                   ///< the time was over before the search had ended
  std::vector<std::string> not_tried;  ///< effects for which the time was too short
  std::vector<std::string> notes;
};

}  // namespace bodesmith::gap
