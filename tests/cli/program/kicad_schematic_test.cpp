#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include "base/files.hpp"
#include "cli/example_circuits.hpp"
#include "cli/kicad_reader.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

/// compensator.sub with its stages written out, read by this test's own means.
struct Netlist {
  struct Element {
    std::vector<std::string> nodes;  ///< of an op-amp: plus, minus, out
    double value = 0.0;
  };
  std::map<std::string, Element> parts;   ///< R… and C…
  std::map<std::string, Element> opamps;  ///< without the leading X
};

Netlist read_netlist(const std::string& path) {
  struct Line {
    std::vector<std::string> words;
  };
  std::map<std::string, std::vector<Line>> bodies;
  std::istringstream text(read_file(path));
  std::string line, inside;
  while (std::getline(text, line)) {
    std::istringstream words(line);
    Line one;
    for (std::string word; words >> word;) one.words.push_back(word);
    if (one.words.empty() || one.words[0][0] == '*') continue;
    if (one.words[0] == ".subckt") {
      inside = one.words[1];
    } else if (one.words[0] == ".ends") {
      inside.clear();
    } else if (!inside.empty()) {
      bodies[inside].push_back(one);
    }
  }
  Netlist out;
  for (const Line& call : bodies.at("compensator")) {
    const std::string number = call.words[0].substr(1);
    const std::string body =
        call.words[3] == "compensator_stage" + number ? call.words[3] : std::string("missing");
    const auto node = [&](const std::string& local) {
      if (local == "0") return local;
      if (local == "in") return call.words[1];
      if (local == "out") return call.words[2];
      return "s" + number + "_" + local;
    };
    for (const Line& element : bodies.at(body)) {
      const std::string& name = element.words[0];
      Netlist::Element one;
      if (name[0] == 'X') {
        one.nodes = {node(element.words[1]), node(element.words[2]), node(element.words[3])};
        out.opamps[name.substr(1)] = one;
      } else {
        one.nodes = {node(element.words[1]), node(element.words[2])};
        one.value = std::strtod(element.words[3].c_str(), nullptr);
        out.parts[name] = one;
      }
    }
  }
  return out;
}

double value_of(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const std::map<std::string, double> prefixes = {{"", 1.0},   {"f", 1e-15}, {"p", 1e-12},
                                                  {"n", 1e-9}, {"u", 1e-6},  {"m", 1e-3},
                                                  {"k", 1e3},  {"M", 1e6},   {"G", 1e9}};
  return number * prefixes.at(end);
}

/// The schematic joins exactly what the netlist joins, with the same parts and values.
KicadSchematic expect_same(const std::string& folder, double tolerance = 0.0) {
  const Netlist netlist = read_netlist(folder + "/compensator.sub");
  const std::map<std::string, std::string> references = read_references(folder + "/bom.csv");
  KicadSchematic schematic = read_kicad(folder);
  EXPECT_FALSE(netlist.parts.empty());
  EXPECT_EQ(schematic.dangling_ends, 0);
  EXPECT_EQ(schematic.stacked_texts, 0);
  EXPECT_FALSE(schematic.off_page);

  std::map<std::string, int> net_of;
  std::map<int, std::string> node_of;
  const auto same = [&](const std::string& node, int net, const std::string& where) {
    const int known = net_of.try_emplace(node, net).first->second;
    const std::string& other = node_of.try_emplace(net, node).first->second;
    EXPECT_EQ(known, net) << where << ": node " << node << " is in two pieces";
    EXPECT_EQ(other, node) << where << ": two nodes are joined";
  };
  std::set<std::string> parts_drawn;
  for (const auto& [name, part] : netlist.parts) {
    if (!references.contains(name) || !schematic.components.contains(references.at(name))) {
      ADD_FAILURE() << name << " is not drawn";
      continue;
    }
    const auto& drawn = schematic.components.at(references.at(name));
    parts_drawn.insert(references.at(name));
    EXPECT_EQ(drawn.fields.at("Netlist"), name);
    EXPECT_LE(std::abs(value_of(drawn.value) / part.value - 1.0), tolerance + 1e-12) << name << drawn.value;
    EXPECT_FALSE(drawn.footprint.empty()) << name;
    for (const char* field : {"Series", "Tolerance", "Wanted", "Realised", "Section"})
      EXPECT_TRUE(drawn.fields.contains(field) && !drawn.fields.at(field).empty()) << name << field;
    EXPECT_EQ(drawn.pin_nets.size(), 2U) << name;
  }
  // Op-amps first: their pins tell nodes apart, so that a part's two pins can be told apart too.
  std::set<std::string> packages;
  for (const auto& [name, opamp] : netlist.opamps) {
    bool found = false;
    for (const auto& [reference, drawn] : schematic.components) {
      for (const int unit : {1, 2}) {
        const auto field = drawn.fields.find("Netlist@" + std::to_string(unit));
        if (field == drawn.fields.end() || field->second != name) continue;
        found = true;
        packages.insert(reference);
        const bool dual = drawn.pin_nets.contains("8");
        const char* const plus = unit == 2 ? "5" : "3";
        const char* const minus = unit == 2 ? "6" : "2";
        const char* const output = dual ? (unit == 2 ? "7" : "1") : "6";
        same(opamp.nodes[0], drawn.pin_nets.at(plus), name);
        same(opamp.nodes[1], drawn.pin_nets.at(minus), name);
        same(opamp.nodes[2], drawn.pin_nets.at(output), name);
        const char* const positive = dual ? "8" : "7";
        EXPECT_TRUE(schematic.names.at(drawn.pin_nets.at(positive)).contains("VCC")) << reference;
        EXPECT_TRUE(schematic.names.at(drawn.pin_nets.at("4")).contains("VEE")) << reference;
      }
    }
    EXPECT_TRUE(found) << name << " is not drawn";
  }
  // Names tell the rest: every net has at most one, the node's own.
  for (const auto& [net, names] : schematic.names) {
    std::set<std::string> plain;
    for (const std::string& name : names) plain.insert(name.substr(name.find_last_of('/') + 1));
    if (plain.empty()) continue;
    EXPECT_EQ(plain.size(), 1U) << *plain.begin() << " and " << *plain.rbegin() << " are one net";
    const std::string node = *plain.begin() == "GND" ? "0" : *plain.begin();
    if (node != "VCC" && node != "VEE") same(node, net, "label");
  }
  // Parts: by what is known of their nodes, until nothing new is learnt.
  for (size_t pass = 0; pass <= netlist.parts.size(); ++pass) {
    for (const auto& [name, part] : netlist.parts) {
      if (!references.contains(name) || !schematic.components.contains(references.at(name))) continue;
      const auto& pins = schematic.components.at(references.at(name)).pin_nets;
      const int a = pins.at("1"), b = pins.at("2");
      const std::string &p = part.nodes[0], &q = part.nodes[1];
      const auto is = [&](const std::string& node, int net) {
        return net_of.contains(node) && net_of.at(node) == net;
      };
      if (is(p, a) || is(q, b)) {
        same(p, a, name);
        same(q, b, name);
      } else if (is(p, b) || is(q, a)) {
        same(p, b, name);
        same(q, a, name);
      } else {
        EXPECT_LT(pass, netlist.parts.size()) << name << " is connected to nothing known";
      }
    }
  }
  EXPECT_EQ(parts_drawn.size(), netlist.parts.size());
  // Nothing else but what a board needs.
  size_t extra = 0;
  for (const auto& [reference, drawn] : schematic.components) {
    if (parts_drawn.contains(reference) || packages.contains(reference)) continue;
    ++extra;
    EXPECT_TRUE(reference.starts_with("J") || drawn.value == "100n") << reference;
  }
  // Numbered without a gap: as many as there are of each letter.
  for (const char* letter : {"R", "C", "U", "J"}) {
    const auto has = [&](const std::string& name) { return schematic.components.contains(name); };
    const auto count = std::count_if(schematic.components.begin(), schematic.components.end(),
                                     [&](const auto& one) { return one.first.starts_with(letter); });
    EXPECT_TRUE(count == 0 || (has(letter + std::string("1")) && has(letter + std::to_string(count))))
        << letter;
  }
  EXPECT_EQ(extra, 3 + 2 * packages.size());
  EXPECT_TRUE(std::filesystem::exists(folder + "/compensator.kicad_pro"));
  EXPECT_TRUE(std::filesystem::exists(folder + "/bodesmith.kicad_sym"));
  return schematic;
}

const char* const kTwoPoles = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":2e6,"zeros_rad_s":[],"poles_rad_s":[[-400,900],[-400,-900]]},
{"gain":0.5,"zeros_rad_s":[[0,0],[0,0]],"poles_rad_s":[[-40,30],[-40,-30]]},
{"gain":900,"zeros_rad_s":[[0,0]],"poles_rad_s":[[-400,900],[-400,-900]]}]})";
// Sallen-Key with gains above 1; low-passes below 1; a high-pass below 1.
const char* const kLowHigh = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":3e6,"zeros_rad_s":[],"poles_rad_s":[[-500,800],[-500,-800]]},
{"gain":2.5,"zeros_rad_s":[[0,0],[0,0]],"poles_rad_s":[[-30,30],[-30,-30]]}]})";
const char* const kLow = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":4e5,"zeros_rad_s":[],"poles_rad_s":[[-400,900],[-400,-900]]},
{"gain":4e5,"zeros_rad_s":[],"poles_rad_s":[[-500,800],[-500,-800]]}]})";
const char* const kHigh = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":0.5,"zeros_rad_s":[[0,0],[0,0]],"poles_rad_s":[[-40,30],[-40,-30]]}]})";
const char* const kSeed = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":0.918,"zeros_rad_s":[[-48.79,0],[-14.8,0]],"poles_rad_s":[[-47.49,0],[-13.99,0]]},
{"gain":1.885,"zeros_rad_s":[[-107.6,0],[-63.68,0]],"poles_rad_s":[[-126.4,0],[-102.2,0]]},
{"gain":0.318,"zeros_rad_s":[[-380.2,0],[-221.6,0]],"poles_rad_s":[[-214.9,0],[-124.8,0]]},
{"gain":2.628,"zeros_rad_s":[[-400,0],[-365.6,0]],"poles_rad_s":[[-652.1,0],[-589.4,0]]}]})";
const char* const kMixed = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":1.0,"zeros_rad_s":[[-40,90],[-40,-90]],"poles_rad_s":[[-20,97],[-20,-97]]},
{"gain":2.0,"zeros_rad_s":[[50,0]],"poles_rad_s":[[-300,0]]},
{"gain":300.0,"zeros_rad_s":[],"poles_rad_s":[[-300,0]]},
{"gain":1.5,"zeros_rad_s":[[0,0]],"poles_rad_s":[[-30,0]]},
{"gain":-1.0,"zeros_rad_s":[[300,0]],"poles_rad_s":[[-300,0]]}]})";

TEST(KicadSchematic, EveryRealizationIsTheNetlist) {
  const TemporaryFolder folder;
  write_file(folder / "two.json", kTwoPoles);
  write_file(folder / "lowhigh.json", kLowHigh);
  write_file(folder / "low.json", kLow);
  write_file(folder / "high.json", kHigh);
  write_file(folder / "seed.json", kSeed);
  write_file(folder / "mixed.json", kMixed);
  for (const std::string arguments :
       {"mixed.json", "mixed.json --opamp TL072", "mixed.json --realization khn",
        "two.json --realization khn", "two.json --realization tow-thomas --opamp TL072",
        "two.json --realization multiple-feedback", "lowhigh.json --realization sallen-key --opamp NE5532",
        "low.json --realization sallen-key", "high.json --realization sallen-key", "mixed.json --series E24",
        "lowhigh.json --realization multiple-feedback", "seed.json", "seed.json --realization foster1",
        "seed.json --realization foster2", "seed.json --realization cauer1",
        "seed.json --realization cauer2 --opamp OPA2134"}) {
    SCOPED_TRACE(arguments);
    const ProgramResult run = run_shell("cd '" + (folder / "").string() + "' && " + BODESMITH_PROGRAM +
                                        " spice " + arguments + " --allow-shortfall -o made");
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(expect_same((folder / "made").string()).sheets, 1);
  }
}

TEST(KicadSchematic, EveryExampleIsTheNetlist) {
  const TemporaryFolder folder;
  for (const ExampleCircuit& example : example_circuits()) {
    SCOPED_TRACE(example.name);
    const std::string sections = example_sections(example, folder);
    for (const std::string options : {"", " --series exact --opamp TL072"}) {
      const std::string out = (folder / "made").string();
      std::filesystem::remove_all(out);
      const ProgramResult run = run_bodesmith("spice " + sections + example.limits + options + " -o " + out);
      ASSERT_EQ(run.status, 0) << run.err;
      expect_same(out, !options.empty() ? 1e-5 : 0.0);
    }
  }
}

TEST(KicadSchematic, ManyStagesGoOnSheetsOfTheirOwn) {
  const TemporaryFolder folder;
  std::string text = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[)";
  for (int i = 0; i < 40; ++i) {
    const double pole = 10.0 * std::pow(1.2, i);
    text += (i > 0 ? "," : "") + std::string(R"({"gain":1.0,"zeros_rad_s":[[)") +
            std::to_string(-pole * 1.1) + R"(,0]],"poles_rad_s":[[)" + std::to_string(-pole) + ",0]]}";
  }
  write_file(folder / "many.json", text + "]}");
  const std::string out = (folder / "made").string();
  const ProgramResult run =
      run_bodesmith("spice " + (folder / "many.json").string() + " --opamp TL072 -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_GT(expect_same(out).sheets, 2);
}

TEST(KicadSchematic, SameCircuitSameBytes) {
  const TemporaryFolder folder;
  write_file(folder / "mixed.json", kMixed);
  const std::string sections = (folder / "mixed.json").string();
  for (const char* out : {"a", "b"})
    ASSERT_EQ(run_bodesmith("spice " + sections + " -o " + (folder / out).string()).status, 0);
  EXPECT_EQ(read_file(folder / "a" / "compensator.kicad_sch"),
            read_file(folder / "b" / "compensator.kicad_sch"));
}

// The reader itself must see a wire that is not there and one too many.
TEST(KicadSchematic, ReaderSeesABrokenWire) {
  const TemporaryFolder folder;
  write_file(folder / "mixed.json", kMixed);
  const std::string out = (folder / "made").string();
  ASSERT_EQ(run_bodesmith("spice " + (folder / "mixed.json").string() + " -o " + out).status, 0);
  const KicadSchematic whole = read_kicad(out);
  const std::string text = read_file(folder / "made" / "compensator.kicad_sch");
  const size_t at = text.find("  (wire ");
  std::string cut = text;
  cut.erase(at, cut.find('\n', at) - at);
  write_file(folder / "made" / "compensator.kicad_sch", cut);
  EXPECT_GT(read_kicad(out).dangling_ends, whole.dangling_ends);
}

}  // namespace
}  // namespace bodesmith
