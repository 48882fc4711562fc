#include "spice/plain_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "spice/deck_words.hpp"

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

/// The file that an include line names; empty for any other line.
std::string included_file(std::string_view line) {
  const std::string small = lower_case(trim(line));
  if (!small.starts_with(".inc") && !small.starts_with(".lib")) return {};
  std::string_view rest = trim(line);
  const std::size_t blank = rest.find_first_of(" \t\"'");
  if (blank == std::string_view::npos) return {};
  rest = trim(rest.substr(blank));
  if (!rest.empty() && (rest.front() == '"' || rest.front() == '\'')) {
    const std::size_t end = rest.find(rest.front(), 1);
    return std::string(rest.substr(1, end == std::string_view::npos ? end : end - 1));
  }
  return std::string(rest.substr(0, rest.find_first_of(" \t")));
}

class PlainNetlist {
 public:
  void check(std::string_view text, const fs::path& file, std::size_t depth) {
    if (depth > kDeepest)
      throw InputError(file.string(), 0, "is included too deep, expected at most 16 levels");
    int number = 0, begun = 0;
    std::string joined;
    for (const std::string_view raw : split(text, '\n')) {
      ++number;
      const std::string_view rest = trim(raw);
      if (rest.starts_with('+')) {
        joined += rest.substr(1);
        continue;
      }
      line(joined, file, begun, depth);
      joined = std::string(rest);
      begun = number;
    }
    line(joined, file, begun, depth);
  }

 private:
  void line(const std::string& joined, const fs::path& file, int number, std::size_t depth) {
    const std::string small = squeezed(joined);
    const auto refuse = [&](std::string_view what) {
      throw InputError(file.string(), number, fmt::format("{}, expected a circuit and nothing else", what));
    };
    if (small.starts_with("*ng_script")) refuse("is a script of ngspice");
    if (begins_control(joined)) refuse("has a .control section");
    if (small.starts_with(".model") &&
        (small.find("d_process") != std::string::npos || small.find("d_cosim") != std::string::npos))
      refuse("has a model that runs another program");
    const std::string name = included_file(joined);
    if (name.empty()) return;
    const fs::path path = fs::absolute(file).parent_path() / name;
    std::error_code ec;
    // What is not there is for ngspice to say; a section of this very file has been seen.
    if (!fs::is_regular_file(path, ec) || !seen_.insert(fs::weakly_canonical(path, ec)).second) return;
    check(read_file(path), path, depth + 1);
  }

  std::set<fs::path> seen_;
};

}  // namespace

bool begins_control(std::string_view line) {
  return squeezed(line).starts_with(".control");
}

void require_plain_netlist(std::string_view text, const fs::path& file) {
  PlainNetlist().check(text, file, 0);
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
