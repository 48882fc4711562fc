#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith {

/// How many single changes make one word of another: a letter put in, left out, exchanged, or swapped with its
/// neighbour (optimal string alignment, a form of the Damerau-Levenshtein distance). Bytes, not letters of an alphabet.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The one of `known` that a person meant by `typed`, or nothing when none is near: at most one change in three letters, or
/// the only word that begins with what was typed. Capitals count as small letters, '-' and ' ' as '_'.
std::optional<std::string> nearest_word(std::string_view typed, const std::vector<std::string>& known);

/// " (did you mean 'order'?)" for messages; empty when no word is near. `before` stands before the word ("--").
std::string did_you_mean(std::string_view typed, const std::vector<std::string>& known,
                         std::string_view before = {});

}  // namespace bodesmith
