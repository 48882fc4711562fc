#include "spice/include_line.hpp"

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

}  // namespace bodesmith::spice
