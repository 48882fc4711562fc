#pragma once

#include <optional>
#include <string>
#include <utility>

#include "chain/chain.hpp"
#include "gap/search.hpp"

namespace bodesmith::gap {

/// From which start (zero, or at rest under the first input) the training records are explained, where they begin
/// under bias and the model itself does not say.
struct StartChoice {
  chain::Start chosen = chain::Start::zero;
  /// What each leaves of the training records, whole: of the one, all that the search found; of the other the same
  /// refitted, or what a search of its own found (`by_search`).
  double zero_rms = 0.0;
  double equilibrium_rms = 0.0;
  bool by_search = false;
};
/// One sentence, for a person.
std::string to_text(const StartChoice& choice);

/// search() (again with all starts scored, where one stands out) from the start that explains the training records, where one of them begins under bias and the model does not say
/// how it starts. The start under which the model as given comes nearer is searched from (zero where both are alike). When what was
/// found explains how the records begin, and leaves no more than the same refitted from the other start, that is all; otherwise
/// the other one is searched from too, and what has the greater evidence of the whole records is chosen. No choice: there was none.
std::pair<SearchResult, std::optional<StartChoice>> search_from_start(const chain::Chain& base,
                                                                      const Experiments& train,
                                                                      const SearchOptions& options);

}  // namespace bodesmith::gap
