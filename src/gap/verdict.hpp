#pragma once

#include <string>

#include "gap/search_result.hpp"

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

/// What a search's outcome amounts to. With a floor from periods, what is left counts as something missing
/// when it is more than `enough` times the floor; in any case when signs of structure are left.
Verdict verdict_of(const SearchResult& result, double train_rms, double enough);

}  // namespace bodesmith::gap
