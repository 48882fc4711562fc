#pragma once

#include <map>
#include <string>
#include <vector>

#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// A name is told alone from .9 on (the contract); others, and other places of it, of less than a twentieth are not told alongside it.
constexpr double kTied = 0.05;

/// A candidate that was fitted, is of use and is no other effect's form.
bool is_name(const Ranked& r);

/// Probabilities of the names of one step alongside the others, "" for none: evidence over their sum, an effect's places and forms together.
std::map<std::string, double> names_of_step(const Step& step);

/// The outcomes of a step's ranking: its own name, those that are tied with it, places as good; and Step::tied_with.
void judge_ranking(Step& step);

}  // namespace bodesmith::gap
