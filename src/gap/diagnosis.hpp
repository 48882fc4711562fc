#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chain/chain.hpp"
#include "gap/evidence/posterior.hpp"
#include "gap/report/next_experiment.hpp"
#include "gap/report/size.hpp"
#include "gap/report/where.hpp"
#include "gap/search.hpp"
#include "gap/search/start_choice.hpp"
#include "gap/search_result.hpp"
#include "gap/signs/amplitude_dependence.hpp"
#include "gap/study.hpp"

namespace bodesmith::gap {

enum class Verdict {
  explained,
  partly_explained,
  nothing_missing,
  unexplained,
  interrupted,  ///< the search was stopped before its end: what it found so far, and no judgement
};

/// "explained", "partly_explained", "nothing_missing", "unexplained" or "interrupted", as in diagnosis.json.
std::string to_string(Verdict verdict);

/// What a search's outcome amounts to. What is left counts as something missing when it is more than noise (NoiseFloor::most_noise), and in
/// any case when signs of structure are left.
Verdict verdict_of(const SearchResult& result);

/// A value that a term's fit found, and twice its standard deviation to both sides, the residual's colour
/// counted.
struct FoundParameter {
  std::string name;
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// The best candidate of another effect among those that a step was chosen from; null: there was none.
const Ranked* runner_up_of(const Step& step);

/// One term that was found, with the gap that it leaves.
struct DiagnosedStep {
  std::string effect;
  std::vector<std::string> tied_with;
  std::string placed;
  std::vector<std::string> also_placed;
  std::string part;  ///< Term::part
  std::vector<FoundParameter> parameters;
  GapSize after;
  double among_names = 0.0;  ///< Posterior::among_names
  double probability = 0.0;  ///< the same with what may be outside
};

struct Diagnosis {
  NoiseFloor floor;
  GapSize initial;   ///< the model as given
  GapSize refitted;  ///< its free parameters refitted
  GapSize final;
  std::vector<Cell> where;
  std::vector<Cell> remaining_where;
  std::vector<ConstantOffset> constant_offsets;  ///< of what is left of the held-out records
  std::vector<DiagnosedStep> steps;
  std::vector<NamedSet> alternatives;  ///< Posterior::alternatives
  double outside = 0.0;                ///< Posterior::outside
  /// Of training records that begin under bias.
  std::optional<StartChoice> start;
  /// Of responses at several drives.
  std::optional<AmplitudeDependence> amplitude;
  Verdict verdict = Verdict::unexplained;
  std::string advice;
  std::optional<NextExperiment> next_experiment;  ///< for a tie or an open parameter
  std::vector<ScoredFrom> scored_from;
  /// The final model leaves far more of the held-out records than of the training records, or more than the
  /// base model did.
  bool holdout_disagrees = false;
  bool relative = false;  ///< frequency responses: rms of |H_model/H_measured - 1| parts, no unit
  bool weighted = false;  ///< some of them by their coherence
  SearchResult search;
  double compute_s = 0.0;

  /// The gap that a step found.
  const GapSize& before(std::size_t step) const { return step == 0 ? refitted : steps[step - 1].after; }
};

Diagnosis diagnose(const chain::Chain& base, const Study& study, const SearchOptions& options);

/// What a person should do next: experiments that tell ties apart, records that would say more.
std::string advice_for(const Diagnosis& diagnosis, const Study& study);

}  // namespace bodesmith::gap
