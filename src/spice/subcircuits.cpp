#include "spice/subcircuits.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/letters.hpp"
#include "base/text.hpp"

namespace bodesmith::spice {

std::vector<Subcircuit> list_subcircuits(const std::string& text, const std::string& file) {
  std::vector<Subcircuit> out;
  int depth = 0, number = 0, opened = 0;
  for (const std::string_view raw : split(text, '\n')) {
    ++number;
    std::vector<std::string> words;
    for (const std::string_view word : split(trim(raw), ' ')) {
      if (!trim(word).empty()) words.emplace_back(trim(word));
    }
    if (words.empty()) continue;
    const std::string first = lower_case(words[0]);
    if (first == ".subckt") {
      if (words.size() < 2)
        throw InputError(file, number, ".subckt without a name, expected .subckt NAME PINS");
      if (depth++ > 0) continue;
      opened = number;
      Subcircuit one{words[1], {}, number};
      for (size_t i = 2; i < words.size(); ++i) {
        if (lower_case(words[i]) == "params:" || words[i].find('=') != std::string::npos) break;
        one.pins.push_back(words[i]);
      }
      out.push_back(std::move(one));
    } else if (first == ".ends") {
      if (depth-- == 0) throw InputError(file, number, ".ends without .subckt");
    }
  }
  if (depth > 0) throw InputError(file, opened, ".subckt is not ended, expected .ends");
  return out;
}

std::string pick_subcircuit(const std::vector<Subcircuit>& all, const std::string& wanted,
                            const std::string& file) {
  if (!wanted.empty()) {
    for (const Subcircuit& one : all) {
      if (lower_case(one.name) != lower_case(wanted)) continue;
      if (one.pins.size() != 2) {
        throw InputError(
            file, one.line,
            fmt::format("subcircuit {} has {} pins, expected two: in out", one.name, one.pins.size()));
      }
      return one.name;
    }
    throw InputError(fmt::format("{}: has no subcircuit {}", file, wanted));
  }
  std::string found;
  for (const Subcircuit& one : all) {
    if (one.pins.size() != 2) continue;
    if (lower_case(one.name) == "compensator") return one.name;
    found = one.name;
  }
  if (found.empty())
    throw InputError(fmt::format("{}: has no subcircuit with two pins, expected .subckt NAME in out", file));
  return found;
}

}  // namespace bodesmith::spice
