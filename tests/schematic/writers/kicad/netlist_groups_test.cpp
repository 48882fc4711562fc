// What a netlist has besides parts and op-amps of a chain: contacts, diodes, multipliers, references and what is left over of
// their packages, on the sheet that the reader of tests reads back.
#include "schematic/writers/kicad/netlist_groups.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <tuple>

#include "kept_text.hpp"
#include "schematic/kicad_reader.hpp"
#include "schematic/writers/kicad/schematic.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::kicad {
namespace {

using schematic::Purpose;

/// Eight contacts that close at 1 and five that close at 0, by a level, by its comparator's input, by gates.
schematic::Netlist switched_netlist() {
  schematic::Netlist out;
  out.groups = {{"a sum\nof two lines", Purpose::branch},
                {"powers", Purpose::powers},
                {"switch", Purpose::branch_switch}};
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i);
    out.parts.push_back({schematic::Part::Kind::resistor, "R" + n, "", 0, "x" + n, "m" + n, "E96", 1e3, 1e3});
    out.opamps.push_back({"X" + n, "", 0, "0", "m" + n, "y" + n});
    out.parts.push_back(
        {schematic::Part::Kind::resistor, "Rf" + n, "", 0, "m" + n, "y" + n, "E96", 2e3, 2e3});
  }
  out.opamp.per_package = 2;
  for (int i = 0; i < 4; ++i)
    out.parts.push_back({schematic::Part::Kind::diode, "D" + std::to_string(i), "", 0, "y0",
                         "k" + std::to_string(i), "1N4148", 0.0, 0.0});
  out.multipliers = {{"M1", "x^2/U", 1, "u", "v", "0", "w", 0.0}, {"M2", "", 1, "w", "u", "z", "q", 0.0}};
  out.sources = {{"Vr", "ADR4525 (2.5 V)", "z", 2.5, 1}};
  out.comparators = {{2, "slope", "rises", 1e3, 0.0}};
  out.gates = {{2, "falls", {}, {"rises"}}, {2, "both", {"rises"}, {"other"}}, {2, "again", {"falls"}, {}}};
  const char* controls[] = {"plain", "rises", "falls", "both", "again"};
  for (int i = 0; i < 13; ++i)
    out.contacts.push_back({"S" + std::to_string(i), 2, i == 12 ? "m0" : "y" + std::to_string(i % 3),
                            "b" + std::to_string(i), controls[i % 5], i < 8 ? 2 * (i % 2) : 1});
  return out;
}

TEST(KicadDevices, AllOfANetlistStandsOnTheSheetOnceAndWhatIsLeftOverIsGrounded) {
  const schematic::Netlist netlist = switched_netlist();
  const TemporaryFolder folder;
  OutputSet files(folder / "made");
  SheetOptions options;
  options.stem = "sheet";
  options.ports = {"u", "x0", "x1", "x2"};
  add_netlist_project(netlist, options, files, "");
  files.commit();
  EXPECT_EQ(digest(digests(files)), "a53b24870b34467f");
  const KicadSchematic drawn = read_kicad((folder / "made").string(), "sheet.kicad_sch");
  EXPECT_EQ(drawn.dangling_ends, 0);
  EXPECT_EQ(drawn.stacked_texts, 0);
  EXPECT_EQ(drawn.overlaps, 0);
  EXPECT_FALSE(drawn.off_page);
  const auto net = [&](const KicadSchematic::Component& one, const std::string& pin) {
    const std::set<std::string>& names = drawn.names.at(one.pin_nets.at(pin));
    return names.contains("GND") ? std::string("GND") : *names.begin();
  };
  // IN, S and D of each contact of an ADG413: the first and the last close at 1.
  using Closed = std::tuple<bool, std::string, std::string, std::string>;
  std::multiset<Closed> contacts, wanted;
  std::multiset<std::string> names, wanted_names;
  std::map<std::string, int> count;
  const char* pins[4][3] = {{"1", "3", "2"}, {"16", "14", "15"}, {"9", "11", "10"}, {"8", "6", "7"}};
  for (const auto& [reference, one] : drawn.components) {
    const std::string letter = reference.substr(0, reference.find_first_of("0123456789"));
    ++count[letter];
    for (const auto& [field, name] : one.fields) {
      if (field.starts_with("Netlist@")) names.insert(name);
    }
    if (one.value == "ADG413") {
      for (int unit = 0; unit < 4; ++unit)
        contacts.insert({unit == 0 || unit == 3, net(one, pins[unit][0]), net(one, pins[unit][1]),
                         net(one, pins[unit][2])});
      EXPECT_EQ(net(one, "13") + net(one, "4") + net(one, "5") + net(one, "12"), "VCCVEEGNDV5P");
    }
    const auto name = one.fields.find("Netlist");
    if (name == one.fields.end()) continue;
    const bool first = name->second == "M1";
    if (first || name->second == "M2") {
      EXPECT_EQ(net(one, "8") + net(one, "1") + net(one, "4") + net(one, "5"), first ? "uvGNDw" : "wuzq");
      EXPECT_EQ(net(one, "2") + net(one, "7") + net(one, "6") + net(one, "3"), "GNDGNDV5PV5N");
    }
    if (name->second == "D2") {
      EXPECT_EQ(net(one, "2") + net(one, "1"), "y0k2");
    }
    if (name->second == "Vr") {
      EXPECT_EQ(net(one, "2") + net(one, "6") + net(one, "4"), "V5PzGND");
    }
  }
  // Levels that follow one node alone are that node's, before comparators and gates.
  const std::map<std::string, std::string> behind = {
      {"plain", "plain"}, {"rises", "slope"}, {"falls", "slope"}, {"both", "both"}, {"again", "slope"}};
  for (const schematic::Contact& one : netlist.contacts) {
    wanted.insert({one.position % 2 == 0, behind.at(one.control), one.from, one.to});
    wanted_names.insert(one.name);
  }
  // Eight take four packages, five fill these from the first on.
  for (int spare = 0; spare < 3; ++spare) {
    wanted.insert({false, "GND", "GND", "GND"});
    wanted_names.insert("spare");
  }
  EXPECT_EQ(count["U"], 4 + 2 + 2 + 1);
  EXPECT_EQ(contacts, wanted);
  for (const auto& one : netlist.parts) wanted_names.insert(one.name);
  for (const auto& one : netlist.opamps) wanted_names.insert(one.name);
  for (const auto& one : netlist.multipliers) wanted_names.insert(one.name);
  for (const auto& one : netlist.sources) wanted_names.insert(one.name);
  wanted_names.insert("spare");  // the fourth op-amp
  EXPECT_EQ(names, wanted_names);
  EXPECT_EQ(count["R"], 6);
  EXPECT_EQ(count["D"], 4);
  EXPECT_EQ(count["C"], 4);  // two at each package of op-amps
  EXPECT_EQ(count["J"], 4 + 2);
}

TEST(KicadDevices, PowersComeFirstAndBelongToTheirTitle) {
  const NetlistGroups groups = netlist_groups(switched_netlist(), {"u", "x0", "x1", "x2"}, {});
  ASSERT_EQ(groups.sections.size(), 3u);
  EXPECT_EQ(groups.sections[0].text, "powers");
  EXPECT_EQ(groups.sections[1].text, "a sum\nof two lines");
  EXPECT_EQ(groups.sections[1].text_height(), 5);
  EXPECT_EQ(groups.sections[1].text_width(), 12 + kGap);
  // Contacts and diodes stand three above one another.
  EXPECT_EQ(groups.sections[2].cells.size(), 5u);
  int width = 0;
  for (const Cell& cell : groups.sections[2].cells) width += cell.drawing.right - cell.drawing.left + kGap;
  EXPECT_EQ(groups.sections[2].width(), width);
  EXPECT_EQ(groups.sections[1].cells.size(), 3u + 2u);
}

TEST(KicadDevices, ValuesAndFootprintsGoByTheirDecade) {
  EXPECT_EQ(kicad_value(999e3), "999k");
  EXPECT_EQ(kicad_value(1e3), "1k");
  EXPECT_EQ(kicad_value(999.0), "999");
  EXPECT_EQ(kicad_value(0.1), "100m");
  EXPECT_EQ(kicad_value(2.2e-16), "0.22f");
  EXPECT_EQ(kicad_value(3e13), "30000G");
  schematic::Netlist netlist;
  netlist.groups = {{"c", Purpose::stage}};
  const double farads[] = {10e-9, 10.1e-9, 100e-9, 101e-9, 220e-9, 221e-9};
  for (const double f : farads)
    netlist.parts.push_back({schematic::Part::Kind::capacitor, "C" + std::to_string(netlist.parts.size()), "",
                             0, "a" + std::to_string(netlist.parts.size()), "0", "E12", f, f});
  std::map<std::string, std::string> footprint;
  const NetlistGroups groups = netlist_groups(netlist, {}, {});
  for (const Cell& cell : groups.sections[0].cells) {
    for (const Symbol& one : cell.drawing.symbols) footprint[one.reference] = one.footprint;
  }
  // A size goes to its limit, and no further.
  EXPECT_EQ(footprint.at("C2"), footprint.at("C3"));
  EXPECT_EQ(footprint.at("C4"), footprint.at("C5"));
  EXPECT_EQ(
      (std::set<std::string>{footprint.at("C1"), footprint.at("C2"), footprint.at("C4"), footprint.at("C6")}
           .size()),
      4u);
}

}  // namespace
}  // namespace bodesmith::kicad
