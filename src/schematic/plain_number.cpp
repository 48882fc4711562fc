#include "schematic/plain_number.hpp"

#include <charconv>
#include <cmath>
#include <utility>

#include "base/text.hpp"

namespace bodesmith::schematic {

bool spice_value(const std::string& text, double& value) {
  const char* const last = text.data() + text.size();
  const auto found = std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), last, value);
  if (found.ec != std::errc() || !std::isfinite(value)) return false;
  const std::string suffix = lower_case({found.ptr, last});
  static const std::pair<const char*, double> scales[] = {
      {"meg", 1e6}, {"mil", 25.4e-6}, {"t", 1e12}, {"g", 1e9},   {"k", 1e3},
      {"m", 1e-3},  {"u", 1e-6},      {"n", 1e-9}, {"p", 1e-12}, {"f", 1e-15}};
  for (const auto& [name, scale] : scales) {
    if (suffix.starts_with(name)) {
      value *= scale;
      break;
    }
  }
  return true;
}

std::vector<std::string> words_of(std::string_view line) {
  const std::vector<std::string_view> words = split_words(line);
  return {words.begin(), words.end()};
}

}  // namespace bodesmith::schematic
