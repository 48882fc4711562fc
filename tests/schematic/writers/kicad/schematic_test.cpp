// Sheets read back by the reader of tests: they join what the netlist joins, on their page, no part upon another.
#include "schematic/writers/kicad/schematic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "kept_text.hpp"
#include "schematic/kicad_reader.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::kicad {
namespace {

using schematic::Netlist;
using schematic::Part;

/// Stages of every shape in turn: an inverting amplifier, a ladder and its follower, a Sallen-Key low-pass, an amplifier of two.
struct Chain {
  Netlist netlist;
  std::vector<ChainStage> stages;
};

Chain chain_of(std::size_t count, int per_package) {
  Chain out;
  out.netlist.opamp.per_package = per_package;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string number = std::to_string(i + 1), in = i == 0 ? "in" : "s" + std::to_string(i),
                      inside = "n" + number + "_";
    const std::string end = i + 1 == count ? "out" : "s" + number;
    out.netlist.groups.push_back({"stage " + number, schematic::Purpose::stage});
    out.stages.push_back({in, end, "stage " + number + "\nof a test"});
    int parts = 0;
    const auto part = [&](Part::Kind kind, const std::string& from, const std::string& to) {
      const bool ohm = kind == Part::Kind::resistor;
      const double value = (ohm ? 1e3 : 1e-9) * (1.0 + ++parts);
      out.netlist.parts.push_back({kind, (ohm ? "R" : "C") + std::to_string(parts) + "_" + number, "role", i,
                                   from, to, "E96", value, value});
    };
    const auto resistor = [&](const std::string& from, const std::string& to) {
      part(Part::Kind::resistor, from, to);
    };
    const auto capacitor = [&](const std::string& from, const std::string& to) {
      part(Part::Kind::capacitor, from, to);
    };
    const auto opamp = [&](int unit, const std::string& plus, const std::string& minus,
                           const std::string& to) {
      out.netlist.opamps.push_back({"U" + std::to_string(unit) + "_" + number, "role", i, plus, minus, to});
    };
    switch (i % 4) {
      case 0:
        resistor(in, inside + "m"), resistor(inside + "m", end), capacitor(inside + "m", end);
        opamp(1, "0", inside + "m", end);
        break;
      case 1: {
        std::string at = in;
        for (std::size_t rung = 0; rung <= i % 7; ++rung) {
          const std::string next = inside + std::to_string(rung);
          resistor(at, next), capacitor(next, "0");
          at = next;
        }
        opamp(1, at, end, end);
        break;
      }
      case 2:
        resistor(in, inside + "a"), resistor(inside + "a", inside + "p"), capacitor(inside + "p", "0");
        capacitor(inside + "a", end), resistor(inside + "m", "0"), resistor(end, inside + "m");
        opamp(1, inside + "p", inside + "m", end);
        break;
      default:
        resistor(in, inside + "m"), resistor(inside + "m", inside + "v"),
            capacitor(inside + "m", inside + "v");
        opamp(1, "0", inside + "m", inside + "v");
        resistor(inside + "v", inside + "k"), resistor(inside + "k", end), resistor(in, inside + "k");
        opamp(2, "0", inside + "k", end);
    }
  }
  return out;
}

/// As expect_joined() wants it.
KicadNetlist wanted(const Netlist& netlist) {
  KicadNetlist out;
  for (const Part& part : netlist.parts) out.parts[part.name] = {{part.from, part.to}, part.realised};
  for (const schematic::OpAmp& one : netlist.opamps)
    out.opamps[one.name] = {{one.plus, one.minus, one.out}, 0.0};
  return out;
}

TEST(KicadProject, AChainOfAnyLengthIsItsNetlist) {
  int sheets = 0;
  // The files with op-amps alone and in pairs, which the reader below takes: where one was changed on purpose, look at it.
  const std::map<std::size_t, std::array<std::string, 2>> kept = {
      {1, {"a892d0146bad69a1", "6656bdb9a861c3de"}}, {2, {"29afbdf844fb8ff2", "27c10310762aee9a"}},
      {3, {"a6a9ab65f95d924e", "10c8f52f4135034b"}}, {4, {"f3bf701a5b04dcba", "f208a71212ae4cd1"}},
      {7, {"284eb8de7ef5c90c", "195c91bc06b23597"}}, {12, {"f2f67eb5a624a88e", "219c30c55d0876b0"}},
      {80, {"2f11154324861a5f", "93cb8dd73a1a04c8"}}};
  for (const auto& [count, pair] : kept) {
    for (const int per_package : {1, 2}) {
      SCOPED_TRACE(std::to_string(count) + " stages, op-amps in one package: " + std::to_string(per_package));
      const Chain chain = chain_of(count, per_package);
      const TemporaryFolder folder;
      OutputSet files(folder / "made");
      SheetOptions options;
      options.stem = "compensator";
      options.title = "a chain";
      options.ports = {"in", "out"};
      add_chain_project(chain.netlist, chain.stages, options, files);
      files.commit();
      const std::string made = (folder / "made").string();
      EXPECT_EQ(digest(digests(files)), pair[static_cast<std::size_t>(per_package - 1)]);
      const KicadSchematic drawn = read_kicad(made);
      expect_joined(drawn, wanted(chain.netlist), read_references(made + "/bom.csv"), 0.0);
      EXPECT_GE(drawn.sheets, sheets == 1 ? 1 : sheets);
      if (per_package == 2) sheets = drawn.sheets;
    }
  }
  EXPECT_GT(sheets, 2);
}

/// Branches wider than the op-amp, one or two of them: the output stands behind the longest.
TEST(KicadProject, AFeedbackOfManyPartsInARowHasRoom) {
  for (const auto& [rows, row] : {std::pair{1U, 2U}, {1U, 3U}, {1U, 5U}, {2U, 2U}, {2U, 3U}}) {
    Chain chain = chain_of(1, 1);
    for (std::size_t i = 0; i < rows * row; ++i) {
      const auto node = [&](std::size_t k) { return "row" + std::to_string(k); };
      chain.netlist.parts.push_back({i % 2 == 0 ? Part::Kind::resistor : Part::Kind::capacitor,
                                     "X" + std::to_string(i), "role", 0, i % row == 0 ? "out" : node(i),
                                     (i + 1) % row == 0 ? "n1_m" : node(i + 1), "E96", 1e3, 1e3});
    }
    const TemporaryFolder folder;
    OutputSet files(folder / "made");
    SheetOptions options;
    options.stem = "compensator";
    options.ports = {"in", "out"};
    add_chain_project(chain.netlist, chain.stages, options, files);
    files.commit();
    const std::string made = (folder / "made").string();
    expect_joined(read_kicad(made), wanted(chain.netlist), read_references(made + "/bom.csv"), 0.0);
  }
}

/// The numbers after these words, one set for each place where all stand behind one another.
std::multiset<std::vector<double>> numbers_after(const std::string& text,
                                                 const std::vector<std::string>& words) {
  std::multiset<std::vector<double>> out;
  for (std::size_t at = text.find(words[0]); at != std::string::npos; at = text.find(words[0], at)) {
    std::vector<double> numbers;
    for (const std::string& word : words) {
      at = text.find(word, at) + word.size();
      char* end = nullptr;
      for (double x = std::strtod(text.c_str() + at, &end); end != text.c_str() + at;
           x = std::strtod(text.c_str() + at, &end)) {
        numbers.push_back(std::round(100.0 * x));  // 0.01 mm
        at = static_cast<std::size_t>(end - text.c_str());
      }
    }
    out.insert(numbers);
  }
  return out;
}

/// The picture has the sheet's wires, junctions, symbols and names, all within its edges.
void expect_same_picture(const std::string& svg, const std::string& sheet, const KicadSchematic& drawn) {
  EXPECT_EQ(numbers_after(svg, {"<line x1=\"", "y1=\"", "x2=\"", "y2=\""}),
            numbers_after(sheet, {"(wire (pts (xy ", "(xy "}));
  const auto junctions = numbers_after(svg, {"<circle cx=\"", "cy=\""});
  EXPECT_EQ(junctions, numbers_after(sheet, {"(junction (at "}));
  EXPECT_FALSE(junctions.empty());
  std::multiset<std::vector<double>> symbols, drawn_symbols;
  for (const auto& one : numbers_after(svg, {"class=\"s\" transform=\"translate("})) symbols.insert(one);
  for (const auto& one : numbers_after(sheet, {"(symbol (lib_id ", "(at "}))
    drawn_symbols.insert({one[0], one[1]});
  EXPECT_EQ(symbols, drawn_symbols);
  const auto edge = *numbers_after(svg, {"viewBox=\"0 0 "}).begin();
  for (const auto& text : numbers_after(svg, {"<text x=\"", "y=\""})) {
    EXPECT_GT(text[0], 0.0);
    EXPECT_GT(text[1], 0.0);
    EXPECT_LT(text[0], edge[0]);
    EXPECT_LT(text[1], edge[1]);
  }
  for (const auto& [reference, component] : drawn.components) {
    EXPECT_NE(svg.find(">" + reference + "</text>"), std::string::npos) << reference;
    EXPECT_NE(svg.find(">" + component.value + "</text>"), std::string::npos) << component.value;
  }
}

/// The same groups without a signal's way through them: each named, on the one sheet.
TEST(KicadProject, ANetlistOfGroupsIsOneSheet) {
  const std::map<std::size_t, std::string> kept = {
      {1, "c068f5707a33977a"}, {3, "2f8e763c9fa0f7ef"}, {9, "cf091cd0474f93b1"}, {20, "2ac5fba3907efb26"}};
  for (const auto& [count, picture] : kept) {
    const Chain chain = chain_of(count, 2);
    const TemporaryFolder folder;
    OutputSet files(folder / "made");
    SheetOptions options;
    options.stem = "groups";
    options.ports = {"in", "out"};
    add_netlist_project(chain.netlist, options, files, "");
    files.commit();
    const KicadSchematic drawn = read_kicad((folder / "made").string(), "groups.kicad_sch");
    std::map<std::string, std::string> references;
    for (const auto& [reference, component] : drawn.components) {
      for (const auto& [field, name] : component.fields) {
        if (field == "Netlist") references[name] = reference;
      }
    }
    expect_joined(drawn, wanted(chain.netlist), references, 0.0);
    EXPECT_EQ(drawn.sheets, 1);
    EXPECT_EQ(digest(read_file(folder / "made" / "groups.svg")), picture) << count;
    expect_same_picture(read_file(folder / "made" / "groups.svg"),
                        read_file(folder / "made" / "groups.kicad_sch"), drawn);
  }
}

}  // namespace
}  // namespace bodesmith::kicad
