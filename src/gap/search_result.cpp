#include "gap/search_result.hpp"

#include <array>

namespace bodesmith::gap {

std::string to_string(CandidateOutcome outcome) {
  constexpr std::array kWords = {"",
                                 "named",
                                 "tied",
                                 "other place or form",
                                 "worse",
                                 "takes too little",
                                 "another effect's form, or less than the records can tell"};
  return kWords.at(static_cast<std::size_t>(outcome));
}

}  // namespace bodesmith::gap
