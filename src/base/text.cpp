#include "base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.hpp"

namespace bodesmith {

std::string number_text(double value) {
  if (!std::isfinite(value))
    throw InputError("a result is not a finite number: inputs whose numbers double precision cannot hold");
  char buffer[40];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  std::string out(buffer, result.ptr);
  if (out.find_first_of(".eni") == std::string::npos) out += ".0";
  return out;
}

std::string rounded_text(double value, int digits) {
  // 13210, not 1.321e+04: up to a million people read the digits.
  const double size = std::abs(value);
  if (digits >= 1 && size >= std::pow(10.0, digits) && size < 999999.5) {
    const double unit = std::pow(10.0, std::floor(std::log10(size)) + 1 - digits);
    return fmt::format("{:.0f}", unit * std::round(value / unit));
  }
  return fmt::format("{:.{}g}", value, digits);
}

std::string engineering_text(double value, std::string_view unit, int digits) {
  static constexpr std::pair<double, const char*> kPrefixes[] = {
      {1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1.0, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}, {1e-12, "p"}};
  for (const auto& [scale, prefix] : kPrefixes) {
    // A value that rounds up to the next prefix belongs there: 999.96 is 1 k, not 1000.
    if (std::abs(value) * (1.0 + 0.5 * std::pow(10.0, -digits)) >= scale) {
      return fmt::format("{} {}{}", rounded_text(value / scale, digits), prefix, unit);
    }
  }
  return fmt::format("{} {}", rounded_text(value, digits), unit);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> out;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    out.push_back(text.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return out;
    begin = end + 1;
  }
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> out;
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t\r", at)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    out.push_back(line.substr(at, end - at));
    at = end;
  }
  return out;
}

std::string_view trim(std::string_view text) {
  const char* blank = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

std::string_view next_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  return line;
}

std::string folded_text(std::string_view text) {
  constexpr std::size_t kColumns = 100;
  constexpr std::size_t kWidestLabel = 20;
  std::string out;
  for (std::string_view line : split(text, '\n')) {
    std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t gap = line.find("  ", indent);
    const std::size_t behind = std::min(line.find_first_not_of(' ', gap), line.size());
    indent = 2 + (behind <= kWidestLabel ? behind : indent);
    std::size_t room = kColumns;
    while (line.size() > room) {
      const std::size_t blank = line.rfind(' ', room);
      // A path longer than a line stays whole.
      if (blank == std::string_view::npos || blank < line.find_first_not_of(' ')) break;
      out.append(line.substr(0, blank)).append("\n").append(indent, ' ');
      line.remove_prefix(blank + 1);
      room = kColumns - indent;
    }
    out.append(line).append("\n");
  }
  out.pop_back();
  return out;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

bool parse_number(std::string_view text, double& value) {
  text = trim(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && std::isfinite(value);
}

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
  return text.empty() || std::ranges::find(kUnits, text) != kUnits.end();
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

namespace {

std::string folded(std::string_view word) {
  std::string out;
  for (const char c : word) {
    if (c >= 'A' && c <= 'Z') {
      out += static_cast<char>(c - 'A' + 'a');
    } else {
      out += c == '-' || c == ' ' ? '_' : c;
    }
  }
  return out;
}

/// Longer texts are no slips of the finger, and would take long.
constexpr std::size_t kLongestWord = 64;
/// Fewer letters begin too many words.
constexpr std::size_t kShortestStart = 3;

/// The only word that begins with `start`: "corner" for corner_hz.
std::optional<std::string> only_continuation(const std::string& start,
                                             const std::vector<std::string>& known) {
  if (start.size() < kShortestStart) return std::nullopt;
  std::optional<std::string> out;
  for (const std::string& word : known) {
    if (folded(word).rfind(start, 0) != 0) continue;
    if (out) return std::nullopt;
    out = word;
  }
  return out;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Three rows of the table of distances between beginnings of a and b.
  std::vector<std::size_t> before_last;
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t exchanged = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, exchanged});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = last;
    std::swap(last, row);
  }
  return last[b.size()];
}

std::optional<std::string> nearest_word(std::string_view typed, const std::vector<std::string>& known) {
  const std::string wanted = folded(typed);
  if (wanted.empty() || wanted.size() > kLongestWord) return std::nullopt;
  std::optional<std::string> best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const std::string& word : known) {
    if (word.size() > kLongestWord) continue;
    const std::size_t changes = edit_distance(wanted, folded(word));
    if (changes >= fewest || 3 * changes > std::max(wanted.size(), word.size())) continue;
    // A word of two or three letters of which one is wrong may be any other one.
    if (changes > 0 && std::min(wanted.size(), word.size()) < 3) continue;
    fewest = changes;
    best = word;
  }
  // The beginning of a word is likelier than a word with two letters wrong.
  if (best && fewest <= 1) return best;
  const std::optional<std::string> longer = only_continuation(wanted, known);
  return longer ? longer : best;
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& known,
                         std::string_view before) {
  const auto word = nearest_word(typed, known);
  return word ? " (did you mean '" + std::string(before) + *word + "'?)" : std::string();
}

}  // namespace bodesmith
