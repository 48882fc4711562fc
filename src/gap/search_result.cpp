#include "gap/search_result.hpp"

namespace bodesmith::gap {

std::string to_string(CandidateOutcome outcome) {
  switch (outcome) {
    case CandidateOutcome::not_judged:
      break;
    case CandidateOutcome::named:
      return "named";
    case CandidateOutcome::tied:
      return "tied";
    case CandidateOutcome::other_place_or_form:
      return "other place or form";
    case CandidateOutcome::worse:
      return "worse";
    case CandidateOutcome::takes_too_little:
      return "takes too little";
    case CandidateOutcome::too_free:
      return "too free without another excitation held out";
    case CandidateOutcome::no_name:
      return "another effect's form, or less than the records can tell";
  }
  return {};
}

}  // namespace bodesmith::gap
