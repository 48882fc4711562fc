#pragma once

#include <string>
#include <vector>

#include "gap/search/records.hpp"

namespace bodesmith::gap {

/// The base model with its own freedom used: what its free parameters can explain is not missing.
struct BaseFit {
  Model model;
  SearchRecords records;  ///< starts left out that stand out under the model
};
BaseFit fit_base(const SearchSetting& setting, SearchRecords records);

/// Values of the base model's unknowns from which its fits begin. Parameters that are off make the sum of
/// squares hilly (a resonance beside its peak): frequencies are first tried over a comb, each alone and all
/// together, the output's size left free, and the best few that lie apart are kept behind the given values.
std::vector<std::vector<double>> base_starts(const SearchSetting& setting, const Experiments& look);

}  // namespace bodesmith::gap
