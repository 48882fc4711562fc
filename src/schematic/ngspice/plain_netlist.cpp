#include "schematic/ngspice/plain_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::ngspice {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDeepest = 16;

/// Small letters without blanks: how ngspice may see a line once it has joined it.
std::string squeezed(std::string_view line) {
  std::string out;
  for (const char c : lower_case(line))
    if (static_cast<unsigned char>(c) > ' ') out += c;
  return out;
}

/// A comment that ngspice takes for a command of its own. Rulers of these signs alone say nothing.
bool is_hidden_command(std::string_view line) {
  const std::string text = squeezed(line);
  const std::size_t begin = line.find_first_not_of(" \t\r\n\f\v");
  return begin != std::string_view::npos && line.substr(begin).starts_with("*#") &&
         text.find_first_not_of("*#-=_") != std::string::npos;
}

/// What continuation lines are not joined to: ngspice passes over it.
bool is_comment(std::string_view line) {
  return line.empty() || std::string_view("*#$").find(line.front()) != std::string_view::npos;
}

/// Of a section that .lib begins.
bool is_plain_word(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return is_letter_or_digit(c) || c == '_'; });
}

enum class Includes { of_own_folder, none, looked_at };

class PlainNetlist {
 public:
  explicit PlainNetlist(Includes includes) : includes_(includes) {}

  void check(std::string_view text, const fs::path& file, std::size_t depth) {
    if (depth > kDeepest)
      throw InputError(file.string(), 0, "is included too deep, expected at most 16 levels");
    std::error_code ec;
    const fs::path name = fs::weakly_canonical(file, ec);
    open_.push_back(name);
    int number = 0, begun = 0;
    std::string joined;
    for (const std::string_view raw : split(text, '\n')) {
      ++number;
      const std::string_view rest = trim(raw);
      if (is_hidden_command(raw)) refuse(file, number, "has a command in a comment");
      if (squeezed(raw).starts_with("*ng_script")) refuse(file, number, "is a script of ngspice");
      if (is_comment(rest)) continue;
      if (rest.starts_with('+')) {
        if (include_line(joined)) refuse(file, number, "goes on with an included file's name");
        joined += rest.substr(1);
        continue;
      }
      line(joined, file, begun, depth);
      joined = std::string(rest);
      begun = number;
    }
    line(joined, file, begun, depth);
    open_.pop_back();
  }

 private:
  [[noreturn]] static void refuse(const fs::path& file, int number, std::string_view what) {
    throw InputError(file.string(), number, fmt::format("{}, expected a circuit and nothing else", what));
  }

  void line(const std::string& joined, const fs::path& file, int number, std::size_t depth) {
    const std::string small = squeezed(joined);
    if (begins_control(joined)) refuse(file, number, "has a .control section");
    if (small.starts_with(".model") &&
        (small.find("d_process") != std::string::npos || small.find("d_cosim") != std::string::npos))
      refuse(file, number, "has a model that runs another program");
    const std::optional<IncludeLine> include = include_line(joined);
    if (!include || includes_ == Includes::looked_at) return;
    if (includes_ == Includes::none) refuse(file, number, fmt::format("includes {}", include->file));
    if (include->library && include->section.empty() && is_plain_word(include->file)) return;
    const fs::path path = included_file(*include, file, number);
    std::error_code ec;
    const fs::path name = fs::weakly_canonical(path, ec);
    // A section of this very file has been seen.
    if (!(include->library && !include->section.empty()) && std::ranges::find(open_, name) != open_.end())
      throw InputError(file.string(), number,
                       fmt::format("includes {}, which includes this in turn, without end", include->file));
    remember_input(path);
    if (seen_.insert(name).second) check(read_file(path), path, depth + 1);
  }

  Includes includes_;
  std::set<fs::path> seen_;
  std::vector<fs::path> open_;  ///< the files on the way to the one that is read
};

}  // namespace

bool begins_control(std::string_view line) {
  return squeezed(line).starts_with(".control");
}

void require_plain_netlist(std::string_view text, const fs::path& file) {
  PlainNetlist(Includes::of_own_folder).check(text, file, 0);
}

void require_plain_text(std::string_view text, const std::string& what) {
  PlainNetlist(Includes::none).check(text, what, 0);
}

void require_no_commands(std::string_view text, const std::string& what) {
  PlainNetlist(Includes::looked_at).check(text, what, 0);
}

void require_plain_node(const std::string& node, const std::string& what) {
  const bool plain = !node.empty() && std::ranges::all_of(node, [](unsigned char c) {
    return c > 127 || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("_.:+-#/[]").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (!plain)
    throw InputError(fmt::format("{}: a node is named '{}', expected letters and digits", what, node));
}

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
      std::ranges::find(name, fs::path("..")) != name.end())
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
    const std::vector<std::string> words = schematic::words_of(raw);
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

}  // namespace bodesmith::ngspice
