#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gap/search/records.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// What a fit leaves on the folds.
struct LeftOnFolds {
  double rms;
  const std::vector<double>& residuals;
};
/// Whether one fit is as good as another there: less than `surely` worse (a share of the rms), or less than a tie allows and
/// not significantly. Residuals of other lengths are no ground for the second.
bool as_good_on_folds(const AcceptanceOptions& options, const LeftOnFolds& one, const LeftOnFolds& than,
                      double surely);

/// The rms of which a later term must explain a part, lest it be the form of those that stand already: of the first gap; of what
/// they leave where all of them are signals without a form (offset, drift, hum).
double gap_to_explain(const SearchSetting& setting, const SearchRecords& records, const Model& model);

/// What a term takes, on folds of the training records and on all of them the smaller of the two.
struct Gain {
  double share = 0.0;      ///< of the rms
  double z = 0.0;          ///< standard deviations
  double explained = 0.0;  ///< rms of it
};
/// What speaks against such a gain; not_judged: nothing. The same when a term comes in and as long as it stays: what is named must
/// not hang on which of several names came first. `first_gap`: gap_to_explain() of what stands beside it; 0: nothing does.
CandidateOutcome too_little_of(const AcceptanceOptions& options, const Effect& effect, std::size_t unknowns,
                               const Gain& gain, double first_gap);

/// What a round comes to: the candidates with their outcomes, and the term that earned its place.
struct Judgement {
  std::optional<Step> step;
  std::vector<Ranked> ranking;  ///< most promising first
};
Judgement judge(const SearchSetting& setting, const SearchRecords& records, const Model& before,
                std::vector<Ranked> ranking);

/// Two effects can hide each other: neither earns its place while the other one's share stands as noise. When
/// nothing does alone and yet something is left, the most promising ones are put in on trial; they stay when
/// a second one then earns its place and they earn theirs beside it.
struct Pair {
  Step first;
  Step second;
  std::string note;
};
std::optional<Pair> choose_pair(const SearchSetting& setting, const SearchRecords& records,
                                const Model& before, const std::vector<Ranked>& ranking);

}  // namespace bodesmith::gap
