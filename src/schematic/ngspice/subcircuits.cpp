#include "schematic/ngspice/subcircuits.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/letters.hpp"
#include "base/text.hpp"

namespace bodesmith::spice {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBlanks = " \t\r\f\v";

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin);
}

/// The word at the beginning, in quotes or not, taken off `rest`.
std::string take_word(std::string_view& rest) {
  rest = without_blanks(rest);
  if (rest.empty()) return {};
  std::size_t begin = 0, end = 0;
  if (rest.front() == '"' || rest.front() == '\'') {
    begin = 1;
    end = std::min(rest.find(rest.front(), 1), rest.size());
  } else {
    end = std::min(rest.find_first_of(" \t\r\f\v\"'"), rest.size());
  }
  std::string out(rest.substr(begin, end - begin));
  rest.remove_prefix(std::min(end + begin, rest.size()));
  return out;
}

}  // namespace

std::optional<IncludeLine> include_line(std::string_view line) {
  std::string_view rest = without_blanks(line);
  const std::string small = lower_case(rest.substr(0, 4));
  if (small != ".inc" && small != ".lib") return std::nullopt;
  rest.remove_prefix(std::min(rest.find_first_of(" \t\r\f\v\"'"), rest.size()));
  IncludeLine out;
  out.library = small == ".lib";
  out.file = take_word(rest);
  if (out.file.empty()) return std::nullopt;
  if (out.library) out.section = take_word(rest);
  if (out.section.starts_with(';') || out.section.starts_with('$')) out.section.clear();  // a comment
  return out;
}

fs::path included_file(const IncludeLine& include, const fs::path& netlist, int line) {
  const auto refuse = [&](std::string_view what) {
    throw InputError(netlist.string(), line, fmt::format("includes {}, {}", include.file, what));
  };
  const fs::path name(include.file);
  if (name.is_absolute() || include.file.front() == '~' ||
      std::find(name.begin(), name.end(), fs::path("..")) != name.end())
    refuse("expected a file in its own folder or below (a copy or a link there)");
  // ngspice ends a name at the first quote of either kind, and that of a .lib at a blank too.
  if (include.file.find_first_of(include.library ? " \t\"'" : "\"'") != std::string::npos)
    refuse("expected a name without blanks and quotes");
  const fs::path out = fs::absolute(netlist).parent_path() / name;
  std::error_code ignored;
  if (!fs::is_regular_file(out, ignored)) refuse("which is not there");
  return out;
}

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
