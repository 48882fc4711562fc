#include "gap/search_result.hpp"

namespace bodesmith::gap {

std::string to_string(CandidateOutcome outcome) {
  switch (outcome) {
    case CandidateOutcome::not_judged:
      break;
    case CandidateOutcome::named:
      return "named";
    case CandidateOutcome::named_in_pair:
      return "named in a pair";
    case CandidateOutcome::tied:
      return "tied";
    case CandidateOutcome::also_fits_with_more_unknowns:
      return "also fits, with more unknowns";
    case CandidateOutcome::other_place_or_form:
      return "other place or form";
    case CandidateOutcome::worse:
      return "worse";
    case CandidateOutcome::no_gain_on_folds:
      return "no gain on folds";
    case CandidateOutcome::not_significant:
      return "not significant";
    case CandidateOutcome::too_free:
      return "too free without another excitation held out";
    case CandidateOutcome::ill_conditioned:
      return "ill-conditioned";
    case CandidateOutcome::at_end_of_range:
      return "at the end of its range";
    case CandidateOutcome::no_name:
      return "another effect's form, or less than the records can tell";
  }
  return {};
}

}  // namespace bodesmith::gap
