#pragma once

#include <optional>
#include <string>

#include "chain/chain.hpp"
#include "gap/search.hpp"

namespace bodesmith::gap {

/// From which start (zero, or at rest under the first input) the training records are explained, where they begin
/// under bias and the model itself does not say.
struct StartChoice {
  chain::Start chosen = chain::Start::zero;
  /// What each leaves of the training records, whole: the base model refitted, or where that does not decide
  /// (`by_terms`) all that the searches found.
  double zero_rms = 0.0;
  double equilibrium_rms = 0.0;
  bool by_terms = false;
};
/// One sentence, for a person.
std::string to_text(const StartChoice& choice);

struct StartedSearch {
  SearchResult search;
  std::optional<StartChoice> start;  ///< nothing: there was nothing to choose
};
/// search() from the start that explains the training records. Where one of them begins under bias and the model does not
/// say how it starts, both are tried: on the base model, and where that does not decide, by two whole searches. Zero needs no
/// key in model.toml and is kept unless equilibrium explains the records, their starts included, better.
StartedSearch search_from_start(const chain::Chain& base, const Experiments& train,
                                const SearchOptions& options);

}  // namespace bodesmith::gap
