#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "gap/search/backward_elimination.hpp"
#include "gap/search/records.hpp"

namespace bodesmith::gap {

/// Where a search has come to.
struct State {
  Found found;
  SearchRecords records;
  std::vector<Ranked> first;    ///< ranking of the first round
  std::vector<Ranked> refused;  ///< of the round in which nothing earned its place
  std::vector<std::string> not_tried = {};
  std::size_t looked_at = 0;
  bool smooth_input = false;
  /// The last round left no less and does not count: its ranking is of another model.
  bool taken_back = false;
  std::set<const Effect*> barred = {};  ///< names that had to explain all and did not
  bool other_way = false;               ///< begun again with another first name
  bool partners_tried = false;          ///< every term against every effect beside the others
  std::vector<Sign> structure = {};     ///< what is left
  double train_rms = 0.0;
};

/// Whether nothing is missing any more: no sign of structure, and no more than enough above the floor.
bool is_settled(const SearchOptions& options, const State& state);

/// A round's terms put in: earlier ones tested again, starts looked at again, and all of it settled. False when what
/// comes of it leaves no less: its notes and what is scored are then kept, and no terms.
bool take(const SearchSetting& setting, State& state, std::vector<Step> steps);

}  // namespace bodesmith::gap
