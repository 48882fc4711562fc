#pragma once

#include <map>
#include <string>
#include <vector>

#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// Probabilities of the names of one step beside the others, "" for none: evidence over their sum, an effect's places and forms together.
std::map<std::string, double> names_of_step(const Step& step);

/// The outcomes of a step's ranking: its own name, those that are tied with it, places as good; and Step::tied_with.
void judge_ranking(Step& step);

}  // namespace bodesmith::gap
