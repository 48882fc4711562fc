// The sheet as LTspice reads it: pins of its own symbols where its library has them, wires, names of nets.
#include "schematic/writers/ltspice_sheet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace bodesmith::schematic {
namespace {

using Place = std::pair<int, int>;

struct ReadSheet {
  std::map<std::string, std::vector<std::string>> nets;  ///< of every symbol's pins, by its name
  std::map<std::string, std::string> values;
  std::vector<std::string> directives;
};

ReadSheet read_sheet(const std::string& text) {
  const std::map<std::string, std::vector<Place>> pins = {
      {"res", {{16, 16}, {16, 96}}},
      {"cap", {{16, 0}, {16, 64}}},
      {"voltage", {{0, 16}, {0, 96}}},
      {"Opamps\\\\opamp", {{-32, 80}, {-32, 48}, {32, 64}}}};
  std::map<Place, std::string> net_at;  // the near end of each wire
  std::map<Place, Place> wires;
  std::set<Place> taken;
  int lowest = 0;  // y grows downwards: each line of text stands below all symbols and the lines before
  ReadSheet out;
  Place size{}, origin{};
  std::string line, kind, name;
  for (std::istringstream lines(text); std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    int x = 0, y = 0, x2 = 0, y2 = 0;
    words >> word;
    if (word == "SHEET") {
      words >> word >> size.first >> size.second;
    } else if (word == "WIRE") {
      words >> x >> y >> x2 >> y2;
      EXPECT_TRUE((x == x2) != (y == y2)) << line;
      EXPECT_TRUE(wires.emplace(Place{x, y}, Place{x2, y2}).second) << line;
    } else if (word == "FLAG") {
      words >> x >> y >> word;
      EXPECT_TRUE(net_at.emplace(wires.at({x, y}), word).second) << line;
    } else if (word == "SYMBOL") {
      words >> kind >> origin.first >> origin.second >> word;
      EXPECT_EQ(word, "R0");
      EXPECT_TRUE(taken.insert(origin).second) << line;
      EXPECT_TRUE(origin.first >= 0 && origin.second >= 0 && origin.first < size.first &&
                  origin.second < size.second)
          << line;
      lowest = std::max(lowest, origin.second + 96);
    } else if (word == "SYMATTR") {
      words >> word;
      if (word == "InstName") {
        words >> name;
        for (const auto& [dx, dy] : pins.at(kind))
          out.nets[name].push_back(net_at.at({origin.first + dx, origin.second + dy}));
      } else if (word == "Value") {
        words >> out.values[name];
      }
    } else if (word == "TEXT") {
      words >> x >> y;
      EXPECT_TRUE(y > lowest && y < size.second) << line;
      lowest = y;
      out.directives.push_back(line.substr(line.find(" 2 ") + 3));
    }
  }
  return out;
}

TEST(LtspiceSheet, ItsNetsAreTheNetlists) {
  Netlist n;
  n.groups = {{"a"}, {"b"}, {"c"}};
  for (std::size_t group = 0; group < 3; ++group) {
    const std::string number = std::to_string(group);
    const std::string in = group == 0 ? "in" : "s" + number;
    const std::string out = group == 2 ? "out" : "s" + std::to_string(group + 1);
    for (std::size_t i = 0; i <= group; ++i) {
      n.parts.push_back({Part::Kind::resistor, "R" + std::to_string(i) + "_" + number, "", group, in,
                         "m" + number, "E96", 1e3, 1e3 + static_cast<double>(i)});
      n.parts.push_back({Part::Kind::capacitor, "C" + std::to_string(i) + "_" + number, "", group,
                         "m" + number, out, "E12", 1e-9, 2.2e-9});
    }
    n.opamps.push_back({"U1_" + number, "", group, "0", "m" + number, out});
  }
  const ReadSheet sheet = read_sheet(ltspice_sheet(n, {Hertz{10.0}, Hertz{1e3}}, "a test"));
  ASSERT_EQ(sheet.nets.size(), n.parts.size() + n.opamps.size() + 1);
  for (const Part& part : n.parts) {
    EXPECT_EQ(sheet.nets.at(part.name), (std::vector{part.from, part.to})) << part.name;
    EXPECT_EQ(std::stod(sheet.values.at(part.name)), part.realised);
  }
  for (const OpAmp& one : n.opamps)
    EXPECT_EQ(sheet.nets.at(one.name), (std::vector{one.plus, one.minus, one.out})) << one.name;
  EXPECT_EQ(sheet.nets.at("V1"), (std::vector<std::string>{"in", "0"}));
  EXPECT_EQ(sheet.directives.at(1), "!.ac dec 50 1.0 10000.0");
}

}  // namespace
}  // namespace bodesmith::schematic
