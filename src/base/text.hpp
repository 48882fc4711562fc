#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith {

/// Letters, digits and blanks as files and commands know them: those of ASCII, whatever the locale of the process. Those of
/// the C library follow it (under a Turkish one 'I' has no small letter), and a host such as Python may set it.
constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
constexpr bool is_letter_or_digit(char c) {
  return is_letter(c) || is_digit(c);
}
/// Space, tab, and what ends lines and pages.
constexpr bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}
constexpr char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
constexpr char upper_case(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

inline std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower_case(c);
  return out;
}
inline std::string upper_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = upper_case(c);
  return out;
}

/// Shortest decimal text that reads back as exactly the same double ("1.0" style for whole numbers).
std::string number_text(double value);

/// `value` with `digits` significant digits and no superfluous zeros: 0.0163, 1.5e+09.
std::string rounded_text(double value, int digits = 4);

/// With the prefix that engineers write: engineering_text(20500, "Ω") is "20.5 kΩ", engineering_text(1e-8,
/// "F") "10 nF".
std::string engineering_text(double value, std::string_view unit, int digits = 3);

/// Pieces between separators; "a,,b" has three.
std::vector<std::string_view> split(std::string_view text, char separator);
/// The words of a line, between blanks and tabs.
std::vector<std::string_view> split_words(std::string_view line);
std::string_view trim(std::string_view text);
/// The first line without its end, taken off the front of `text`.
std::string_view next_line(std::string_view& text);
/// Lines of more than 100 characters broken at blanks; the rest is indented by two more than the line, or than what
/// stands behind its label ("target     points.csv").
std::string folded_text(std::string_view text);
std::string join(const std::vector<std::string>& parts, std::string_view separator);

/// Reads one number that fills the whole text. False when it does not, or is not finite. Ignores the locale.
bool parse_number(std::string_view text, double& value);

/// A number as a person writes it: 47k, 4k7, 4R7, 10n, 2u2, 13.2 kHz, 220nF, 3 dB. Prefixes p n u µ m k M G, units Hz,
/// ohm (Ω), F, V, A, s, dB, deg and %, which are read over: the caller's own name says the unit. False when the text is
/// something else or not finite. Plain numbers are numbers too.
bool parse_quantity(std::string_view text, double& value);

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
