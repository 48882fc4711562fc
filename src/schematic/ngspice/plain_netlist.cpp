#include "schematic/ngspice/plain_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/letters.hpp"
#include "base/text.hpp"
#include "schematic/ngspice/subcircuits.hpp"

namespace bodesmith::spice {
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
  return std::all_of(text.begin(), text.end(), [](char c) { return is_letter_or_digit(c) || c == '_'; });
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
    if (!(include->library && !include->section.empty()) &&
        std::find(open_.begin(), open_.end(), name) != open_.end())
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
  const bool plain = !node.empty() && std::all_of(node.begin(), node.end(), [](unsigned char c) {
    return c > 127 || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("_.:+-#/[]").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (!plain)
    throw InputError(fmt::format("{}: a node is named '{}', expected letters and digits", what, node));
}

}  // namespace bodesmith::spice
