#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gap/search/acceptance.hpp"
#include "gap/search/records.hpp"

namespace bodesmith::gap {

// Frequency responses only, where a fit costs milliseconds: terms that are looked for several at a time, because each
// alone explains little of what they do together (three modes), or because one of another name imitates them (two lags, a
// hold).

/// Terms that earn their places together, in the order of the last one's model.
struct Group {
  std::vector<Step> steps;
  std::vector<Ranked> ranking;  ///< of the last step
  std::string note;
};

/// The best pair of terms, or the best chain of modes, that leaves far less than the round's own step (null: it named
/// nothing) while something is left with that; or the best pair that does as well as a far-fetched single name
/// (Effect::is_far_fetched) with no more unknowns. `ranking`: of the round.
std::optional<Group> choose_group(const SearchSetting& setting, const SearchRecords& records,
                                  const Model& before, const std::vector<Ranked>& ranking,
                                  const Step* single);

}  // namespace bodesmith::gap
