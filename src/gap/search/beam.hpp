#pragma once

#include <set>
#include <string>
#include <vector>

#include "gap/search/records.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// A set of placed effects, fitted.
struct PlacedSet {
  Model model;
  double log_evidence = 0.0;
  double train_rms = 0.0;
  /// What each term was chosen from: the last round that was fitted with it out, and the evidence of the model without it there.
  struct Rivals {
    std::vector<Ranked> ranking;
    double log_evidence_without = 0.0;
  };
  std::vector<Rivals> rivals;
  std::vector<std::string> notes;
};

/// The names of a model's terms, in the order of the alphabet.
std::multiset<std::string> names_of(const Model& model);

/// Where a search stands.
struct Beam {
  SearchRecords records;
  PlacedSet best;
  std::vector<Ranked> first;    ///< ranking of the first round
  std::vector<Ranked> refused;  ///< of the round in which nothing was worth its name
  std::vector<std::string> not_tried = {};
  bool smooth_input = false;
};

/// From the base model to the set of the greatest evidence that these moves lead to: one effect more; one less; another in the place
/// of one, alongside the others; and, where something is left or many unknowns stand, two at once.
void search_sets(const SearchSetting& setting, Beam& beam);

}  // namespace bodesmith::gap
