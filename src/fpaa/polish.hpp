#pragma once

#include "fpaa/chain_search.hpp"
#include "fpaa/choice_state.hpp"

namespace bodesmith::fpaa {

/// Improves a choice until nothing near it is better: every branch by itself over all its candidates, then
/// every pair and triple of branches exhaustively among the neighbours of the present choice (of which only
/// those whose total gain fits are looked at closely), round after round. The gain is kept where it suits the
/// shape at hand.
ChoiceState polished(ChoiceState state, const SearchEffort& effort);

}  // namespace bodesmith::fpaa
