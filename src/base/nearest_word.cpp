#include "base/nearest_word.hpp"

#include <algorithm>
#include <limits>

namespace bodesmith {
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
