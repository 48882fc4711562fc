#pragma once

#include "gap/search/records.hpp"

namespace bodesmith::gap {

/// The base model with its own freedom used: what its free parameters can explain is not missing.
struct BaseFit {
  Model model;
  SearchRecords records;  ///< starts left out that stand out under the model
};
BaseFit fit_base(const SearchSetting& setting, SearchRecords records);

}  // namespace bodesmith::gap
