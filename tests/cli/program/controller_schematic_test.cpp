#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "base/files.hpp"
#include "run_program.hpp"
#include "schematic/kicad_reader.hpp"

namespace bodesmith {
namespace {

/// Some subcircuits of a library, line by line.
std::vector<std::vector<std::string>> elements_of(const std::string& path,
                                                  const std::set<std::string>& subcircuits) {
  std::vector<std::vector<std::string>> out;
  std::istringstream text(read_file(path));
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::vector<std::string> one;
    for (std::string word; words >> word;) one.push_back(word);
    if (one.empty() || one[0][0] == '*') continue;
    if (one[0] == ".ends") inside = false;
    if (inside && one[0][0] != 'E') out.push_back(one);
    if (one[0] == ".subckt" && subcircuits.contains(one[1])) inside = true;
  }
  return out;
}

double drawn_number(const std::string& text) {
  static const std::map<std::string, double> kPrefixes = {
      {"", 1.0}, {"f", 1e-15}, {"p", 1e-12}, {"n", 1e-9}, {"u", 1e-6}, {"m", 1e-3}, {"k", 1e3}, {"M", 1e6}};
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return number * kPrefixes.at(end);
}

/// Nodes of the netlist and nets of the schematic, one to one.
class Pairing {
 public:
  void same(const std::string& node, int net, const std::string& where) {
    const int known = net_of_.try_emplace(node, net).first->second;
    const std::string& other = node_of_.try_emplace(net, node).first->second;
    EXPECT_EQ(known, net) << where << ": node " << node << " is in two pieces";
    EXPECT_EQ(other, node) << where << ": two nodes are joined";
  }
  bool is(const std::string& node, int net) const {
    return net_of_.contains(node) && net_of_.at(node) == net;
  }

 private:
  std::map<std::string, int> net_of_;
  std::map<int, std::string> node_of_;
};

/// The schematic in `folder` beside the netlist there.
class Comparison {
 public:
  explicit Comparison(const std::string& folder)
      : Comparison(folder, "controller.kicad_sch", "controller.sub", {"controller"}) {}
  Comparison(const std::string& folder, const std::string& sheet, const std::string& library,
             const std::set<std::string>& subcircuits)
      : folder_(folder),
        drawn_(read_kicad(folder, sheet)),
        elements_(elements_of(folder + "/" + library, subcircuits)) {}

  void run() {
    EXPECT_EQ(drawn_.dangling_ends, 0);
    EXPECT_EQ(drawn_.stacked_texts, 0);
    EXPECT_FALSE(drawn_.off_page);
    names();
    for (const auto& one : elements_) device(one);
    EXPECT_GT(parts_.size(), 10u);
    for (std::size_t pass = 0; pass <= parts_.size(); ++pass) {
      for (const auto& one : parts_) two_ends(one, pass == parts_.size());
    }
    board();
  }

 private:
  /// Every named net is the node of that name.
  void names() {
    for (const auto& [net, names] : drawn_.names) {
      if (names.empty()) continue;
      EXPECT_EQ(names.size(), 1u) << *names.begin() << " and " << *names.rbegin() << " are one net";
      pairs_.same(*names.begin() == "GND" ? "0" : *names.begin(), net, "name");
    }
  }

  void device(const std::vector<std::string>& line) {
    const std::string& name = line[0];
    switch (name[0]) {
      case 'R':
      case 'C':
        parts_.push_back(line);
        break;
      case 'D':
        ++expected_;
        pins(find(name, 1), {{"2", line[1]}, {"1", line[2]}});
        break;
      case 'V':
        pins(find(name, 1), {{"6", line[1]}, {"4", "0"}, {"2", "V5P"}});
        break;
      case 'X':
        subcircuit(name.substr(1), line);
        break;
      default:
        ADD_FAILURE() << name << " is not expected";
    }
  }

  void subcircuit(const std::string& name, const std::vector<std::string>& line) {
    if (line.back() == "bodesmith_multiplier") {
      pins(find(name, 1), {{"8", line[1]},
                           {"1", line[2]},
                           {"4", line[3]},
                           {"5", line[4]},
                           {"7", "0"},
                           {"2", "0"},
                           {"6", "V5P"},
                           {"3", "V5N"}});
      return;
    }
    if (line.back() == "bodesmith_switch") {
      contact(name, line);
      return;
    }
    for (const int unit : {1, 2}) {
      const std::string package = find(name, unit, false);
      if (package.empty()) continue;
      const bool dual = drawn_.components.at(package).pin_nets.contains("8");
      pins(package, {{unit == 2 ? "5" : "3", line[1]},
                     {unit == 2 ? "6" : "2", line[2]},
                     {!dual       ? "6"
                      : unit == 2 ? "7"
                                  : "1",
                      line[3]},
                     {dual ? "8" : "7", "VCC"},
                     {"4", "VEE"}});
      packages_.insert(package);
      return;
    }
    ADD_FAILURE() << name << " is not drawn";
  }

  /// ADG413: contacts 1 and 4 are closed while their input is high.
  void contact(const std::string& name, const std::vector<std::string>& line) {
    static const std::array<std::array<const char*, 3>, 4> kPins = {
        {{"1", "3", "2"}, {"16", "14", "15"}, {"9", "11", "10"}, {"8", "6", "7"}}};
    for (const int unit : line[3] == "up" || line[3] == "e1" ? std::array{1, 4} : std::array{2, 3}) {
      const std::string package = find(name, unit, false);
      if (package.empty()) continue;
      const auto& pin = kPins[static_cast<std::size_t>(unit - 1)];
      pins(package, {{pin[0], "so"},
                     {pin[1], line[1]},
                     {pin[2], line[2]},
                     {"13", "VCC"},
                     {"4", "VEE"},
                     {"5", "0"},
                     {"12", "V5P"}});
      return;
    }
    ADD_FAILURE() << name << " is not drawn";
  }

  /// Reference of the symbol whose unit carries this netlist name.
  std::string find(const std::string& name, int unit, bool must = true) {
    for (const auto& [reference, one] : drawn_.components) {
      const auto field = one.fields.find("Netlist@" + std::to_string(unit));
      if (field == one.fields.end() || field->second != name) continue;
      if (reference[0] == 'U') chips_.insert(reference);
      return reference;
    }
    if (must) ADD_FAILURE() << name << " is not drawn";
    return {};
  }

  void pins(const std::string& reference, const std::map<std::string, std::string>& nodes) {
    if (!drawn_.components.contains(reference)) {
      ADD_FAILURE() << reference << " is not drawn";
      return;
    }
    for (const auto& [pin, node] : nodes)
      pairs_.same(node, drawn_.components.at(reference).pin_nets.at(pin), reference + " pin " + pin);
  }

  void two_ends(const std::vector<std::string>& line, bool last) {
    const std::string name = find(line[0], 1, last);
    if (name.empty()) return;
    const KicadSchematic::Component& part = drawn_.components.at(name);
    const int a = part.pin_nets.at("1"), b = part.pin_nets.at("2");
    const std::string &p = line[1], &q = line[2];
    const bool along = pairs_.is(p, a) || pairs_.is(q, b), across = pairs_.is(p, b) || pairs_.is(q, a);
    if (along || across) {
      pairs_.same(p, along ? a : b, name);
      pairs_.same(q, along ? b : a, name);
    }
    if (!last) return;
    EXPECT_TRUE(along || across) << name << " is connected to nothing known";
    EXPECT_NEAR(drawn_number(part.value) / std::strtod(line[3].c_str(), nullptr), 1.0, 1e-5) << name;
    EXPECT_EQ(part.fields.at("Netlist"), line[0]);
    EXPECT_FALSE(part.footprint.empty()) << name;
  }

  /// Beside the netlist's: connectors, and two capacitors at every op-amp package.
  void board() {
    std::size_t extra = 0;
    for (const auto& [reference, one] : drawn_.components)
      extra += reference[0] == 'J' || one.fields.count("Netlist") == 0 ? 1U : 0U;
    const std::map<std::string, std::string> listed = read_references(folder_ + "/bom.csv");
    for (const auto& [name, reference] : listed)
      EXPECT_TRUE(drawn_.components.contains(reference)) << name << " is listed as " << reference;
    for (const auto& line : parts_) EXPECT_TRUE(listed.contains(line[0])) << line[0];
    EXPECT_EQ(extra, 4 + 2 * packages_.size());
    EXPECT_EQ(drawn_.components.size(), extra + expected_ + parts_.size() + chips_.size());
  }

  const std::string folder_;
  const KicadSchematic drawn_;
  const std::vector<std::vector<std::string>> elements_;
  Pairing pairs_;
  std::vector<std::vector<std::string>> parts_;
  std::set<std::string> packages_, chips_;
  std::size_t expected_ = 0;
};

const char* const kCurves = R"({"schema": "bodesmith.disturbance/1",
  "ascending": [0.3546, -0.6433, 0.2887], "descending": [-0.2398, 0.0838, 0.156])";

TEST(LayoutSchematic, IsTheNetlist) {
  const TemporaryFolder folder;
  const std::string out = (folder / "layout").string();
  const ProgramResult run =
      run_bodesmith("layout " BODESMITH_SOURCE_DIR "/examples/nanopositioner/disturbance.json -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  Comparison(out, "layout.kicad_sch", "disturbance.sub", {"disturbance", "slope_detector"}).run();
}

TEST(ControllerSchematic, IsTheNetlistInEveryForm) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "plain.json", std::string(kCurves) + "}");
  write_file(folder / "one.json", std::string(kCurves) + R"(,
    "rate": {"frequency_hz": [1, 100], "ascending": [1, 1], "descending": [1, 1.17]}})");
  write_file(folder / "both.json", std::string(kCurves) + R"(,
    "rate": {"frequency_hz": [1, 10, 100], "ascending": [1, 0.8, 1.1], "descending": [1, 1.1, 1.17]}})");
  write_file(folder / "wide.json", std::string(kCurves) + R"(,
    "rate": {"frequency_hz": [0.5, 50, 4000], "ascending": [0.7, 0.8, 1.1], "descending": [1.3, 1.1, 0.6]}})");
  write_file(folder / "zero.json", R"({"schema": "bodesmith.disturbance/1",
    "ascending": [0.3, -0.3, 0], "descending": [0, 0, 0]})");
  write_file(folder / "square.json", R"({"schema": "bodesmith.disturbance/1",
    "ascending": [0, 0.2, -0.2], "descending": [0, -0.1, 0.1],
    "rate": {"frequency_hz": [1, 100], "ascending": [1, 0.5], "descending": [1, 1.5]}})");
  for (const std::string arguments :
       {"plain.json", "both.json --form two-pass", "both.json --form seed", "wide.json",
        "zero.json --form two-pass", "square.json --series E24", "one.json --opamp TL072"}) {
    SCOPED_TRACE(arguments);
    const ProgramResult run =
        run_shell("cd '" + dir + "' && BODESMITH_NGSPICE=/nowhere " + BODESMITH_PROGRAM + " controller " +
                  arguments + " --track-hz 50 --allow-unstable -o made");
    ASSERT_EQ(run.status, 0) << run.err;
    Comparison(dir + "/made").run();
    const std::string picture = read_file(folder / "made" / "controller.svg");
    EXPECT_NE(picture.find("</svg>"), std::string::npos);
    EXPECT_EQ(picture.find("nan"), std::string::npos);
    std::filesystem::remove_all(folder / "made");
  }
}

}  // namespace
}  // namespace bodesmith
