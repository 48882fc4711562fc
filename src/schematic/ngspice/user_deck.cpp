#include "schematic/ngspice/user_deck.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "schematic/ngspice/plain_netlist.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::ngspice {
namespace {

class UserDeckReader {
 public:
  UserDeckReader(const std::filesystem::path& path, std::string node) : path_(path), node_(std::move(node)) {}

  UserDeck read() {
    const std::string whole = read_file(path_);
    // Lines that begin with + belong to the one before.
    std::vector<std::pair<int, std::string>> lines;
    int number = 0;
    for (std::string_view raw : split(whole, '\n')) {
      ++number;
      if (raw.ends_with('\r')) raw.remove_suffix(1);
      const std::string_view rest = trim(raw);
      if (number > 2 && rest.starts_with('+') && !lines.empty()) {
        lines.back().second += " " + std::string(rest.substr(1));
      } else if (number == 1 || !rest.starts_with('*')) {
        lines.emplace_back(number, std::string(raw));
      }
    }
    for (const auto& [at, text] : lines) {
      number_ = at;
      line(text);
      if (ended_) break;
    }
    if (control_ > 0) throw InputError(path_.string(), control_, ".control is not ended, expected .endc");
    if (source_line_ == 0) {
      throw InputError(fmt::format("{}: has no source with an AC value, expected one, e.g. Vin in 0 AC 1",
                                   path_.string()));
    }
    if (node_.empty()) node_ = nodes_.contains("out") ? "out" : printed_;
    if (node_.empty()) {
      throw InputError(
          fmt::format("{}: has no node named out and no .print of one, expected either", path_.string()));
    }
    if (!nodes_.contains(lower_case(node_))) {
      throw InputError(fmt::format("{}: has no node {}", path_.string(), node_));
    }
    return {text_, node_, source_};
  }

 private:
  void line(std::string_view raw) {
    if (number_ == 1) {
      text_ = "a user's deck\n";  // not its own title, which ngspice may take for the beginning of a script
      return;
    }
    const std::vector<std::string> words = schematic::words_of(raw);
    if (words.empty() || words[0][0] == '*') return;
    const std::string first = lower_case(words[0]);
    if (control_ > 0) {
      if (first.starts_with(".endc")) control_ = 0;
      return;
    }
    if (begins_control(raw)) {
      control_ = number_;
      return;
    }
    if (first == ".end") {
      ended_ = true;
      return;
    }
    static const std::set<std::string> outputs = {".print", ".plot", ".save", ".probe"};
    static const std::set<std::string> left_out = {
        ".ac",   ".tran", ".dc", ".op",    ".noise", ".meas", ".measure", ".four",  ".step",
        ".sens", ".tf",   ".pz", ".disto", ".print", ".plot", ".save",    ".probe", ".backanno"};
    if (outputs.contains(first) && printed_.empty()) {
      const std::string all = lower_case(raw);
      const size_t at = all.find("v(");
      if (at != std::string::npos) printed_ = all.substr(at + 2, all.find_first_of("),", at) - at - 2);
    }
    if (left_out.contains(first)) return;
    if (const auto named = include_line(raw)) {
      include(*named);
      return;
    }
    if (first == ".subckt") ++depth_;
    if (first == ".ends" && depth_ > 0) --depth_;
    text_ += std::string(raw) + "\n";
    if (depth_ == 0 && (first[0] == 'v' || first[0] == 'i')) source(words);
    if (depth_ == 0 && first[0] != '.') remember(words);
  }

  void remember(const std::vector<std::string>& words) {
    if (depth_ > 0) return;
    for (size_t i = 1; i < words.size(); ++i) nodes_.insert(lower_case(words[i]));
  }

  void include(const IncludeLine& named) {
    const std::filesystem::path file = included_file(named, path_, number_);
    if (file.string().find_first_of("\"'") != std::string::npos)
      throw InputError(
          path_.string(), number_,
          fmt::format("includes {}, expected a folder without quotes in its name", file.string()));
    remember_input(file);
    require_plain_netlist(read_file(file), file);
    // A .lib without a section would begin one: LTspice means the whole file.
    text_ += fmt::format("{} \"{}\" {}\n", named.section.empty() ? ".include" : ".lib", file.string(),
                         named.section);
  }

  void source(const std::vector<std::string>& words) {
    for (size_t i = 3; i < words.size(); ++i) {
      const std::string word = lower_case(words[i]);
      if (word != "ac" && !word.starts_with("ac=")) continue;
      double magnitude = 1.0, phase = 0.0;
      size_t at = i + 1;
      if (word.starts_with("ac=")) {
        schematic::spice_value(word.substr(3), magnitude);
      } else if (at < words.size() && schematic::spice_value(words[at], magnitude)) {
        ++at;
        if (at < words.size()) schematic::spice_value(words[at], phase);
      }
      if (magnitude == 0.0) return;
      if (source_line_ > 0) {
        throw InputError(
            path_.string(), number_,
            fmt::format("a second source with an AC value (the first is in line {}), expected one",
                        source_line_));
      }
      if (!std::isfinite(magnitude) || !std::isfinite(phase))
        throw InputError(path_.string(), number_, "has an AC value beyond what can be computed with");
      source_line_ = number_;
      source_ = magnitude * std::polar(1.0, to_radians(phase));  // a magnitude below 0 is a turned phase
      return;
    }
  }

  std::filesystem::path path_;
  std::string node_, printed_, text_;
  std::set<std::string> nodes_;
  Complex source_;
  int number_ = 0, control_ = 0, source_line_ = 0, depth_ = 0;
  bool ended_ = false;
};

}  // namespace

UserDeck read_user_deck(const std::filesystem::path& path, const std::string& node) {
  return UserDeckReader(path, node).read();
}

}  // namespace bodesmith::ngspice
