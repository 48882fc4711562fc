#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gap/search/acceptance.hpp"
#include "gap/search/records.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// What a search has found so far: one step for each of the model's terms, in their order.
struct Found {
  Model model;
  std::vector<Step> steps;
  std::vector<std::string> notes;
};

/// A model refitted without one of its terms, and what that term gains.
struct WithoutTerm {
  Model model;
  Gain gain;
  bool earns_its_place = true;  ///< too_little_of() finds nothing
};
WithoutTerm without_term(const SearchSetting& setting, const SearchRecords& records, const Model& with,
                         std::size_t term);

/// Takes out earlier terms that no longer earn their place, and exchanges one of them when a rival does
/// better in its stead now that the later ones are there, or as well with fewer unknowns.
Found test_earlier_terms(const SearchSetting& setting, const SearchRecords& records, Found found);

/// One of several terms exchanged for whatever effect does better beside the others, at any place; nothing when none does:
/// then the ties of all terms are judged again, against every effect.
std::optional<Found> with_any_exchanged(const SearchSetting& setting, const SearchRecords& records,
                                        Found& found);

}  // namespace bodesmith::gap
