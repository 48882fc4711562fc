#include "base/quantity.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "base/letters.hpp"
#include "base/text.hpp"

namespace bodesmith {
namespace {

constexpr std::array<std::pair<std::string_view, int>, 12> kPrefixExponents = {{{"meg", 6},
                                                                                {"p", -12},
                                                                                {"n", -9},
                                                                                {"u", -6},
                                                                                {"\xC2\xB5", -6},
                                                                                {"\xCE\xBC", -6},
                                                                                {"m", -3},
                                                                                {"k", 3},
                                                                                {"K", 3},
                                                                                {"M", 6},
                                                                                {"G", 9},
                                                                                {"R", 0}}};
constexpr std::array<std::string_view, 13> kUnits = {
    "Hz", "hz", "ohm", "Ohm", "\xCE\xA9", "\xE2\x84\xA6", "F", "V", "A", "s", "dB", "deg", "%"};

bool is_unit(std::string_view text) {
  return text.empty() || std::find(kUnits.begin(), kUnits.end(), text) != kUnits.end();
}

/// Digits with at most one point, a sign and an exponent before them: where the number ends.
std::size_t number_length(std::string_view text) {
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
  while (i < text.size() && (is_digit(text[i]) || text[i] == '.')) ++i;
  if (i + 1 < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    std::size_t j = i + 1;
    if (text[j] == '+' || text[j] == '-') ++j;
    if (j < text.size() && is_digit(text[j])) {
      while (j < text.size() && is_digit(text[j])) ++j;
      i = j;
    }
  }
  return i;
}

/// What follows the number: "k", "kHz", "k7", "k7 ohm". Empty when it is none of these.
struct Suffix {
  int exponent = 0;
  std::string_view decimals;
};

std::optional<Suffix> suffix_of(std::string_view text) {
  if (is_unit(text)) return Suffix{};
  for (const auto& [prefix, exponent] : kPrefixExponents) {
    if (text.substr(0, prefix.size()) != prefix) continue;
    Suffix out{exponent, text.substr(prefix.size())};
    std::size_t digits = 0;
    while (digits < out.decimals.size() && is_digit(out.decimals[digits])) ++digits;
    const std::string_view unit = trim(out.decimals.substr(digits));
    out.decimals = out.decimals.substr(0, digits);
    if (is_unit(unit)) return out;
  }
  return std::nullopt;
}

}  // namespace

bool parse_quantity(std::string_view text, double& value) {
  if (parse_number(text, value)) return true;
  text = trim(text);
  const std::size_t length = number_length(text);
  const std::string number(text.substr(0, length));
  const std::optional<Suffix> suffix = suffix_of(trim(text.substr(length)));
  if (number.empty() || !suffix) return false;
  std::string all = number;
  if (!suffix->decimals.empty()) {
    if (number.find_first_of(".eE") != std::string::npos) return false;
    all += "." + std::string(suffix->decimals);
  } else if (number.find_first_of("eE") != std::string::npos) {
    // 1e3k: who means that?
    if (suffix->exponent != 0) return false;
    return parse_number(number, value);
  }
  // As one decimal number, so that 4k7 is the same double as 4700.
  return parse_number(all + "e" + std::to_string(suffix->exponent), value);
}

}  // namespace bodesmith
