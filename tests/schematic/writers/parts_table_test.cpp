#include "schematic/writers/parts_table.hpp"

#include <gtest/gtest.h>

#include "base/documents/json.hpp"

namespace bodesmith::schematic {
namespace {

Netlist one_of_each() {
  Netlist n;
  n.groups = {{"first"}, {"second"}};
  n.parts = {{Part::Kind::resistor, "R1", "input", 0, "in", "m", "E96", 4711.0, 4750.0},
             {Part::Kind::capacitor, "C1", "", 1, "m", "out", "E12", 2.1e-9, 2.2e-9},
             {Part::Kind::diode, "D1", "clamp", 1, "out", "0", "1N4148", 0.0, 0.0}};
  n.opamps = {{"U1", "sum", 0, "0", "m", "out"}, {"U2", "", 1, "0", "m", "out", 1}};
  n.other_opamps.emplace_back().name = "quick";
  n.opamp.name = "slow";
  n.multipliers = {{"M1", "x^2", 1, "out", "v", "0", "w", 0.0}};
  n.contacts = {{"S1", 0, "w", "so", "up", 0}};
  n.sources = {{"V1", "a reference", "v", 0.25, 1}};
  return n;
}

TEST(PartsTable, EveryElementIsARowOfItsColumns) {
  EXPECT_EQ(parts_csv(one_of_each()),
            "part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f,type,role\n"
            "R1,first,E96,4711.0,4750.0,,,resistor,input\n"
            "C1,second,E12,,,2.1e-09,2.2e-09,capacitor,\n"
            "D1,second,,,,,,1N4148,clamp\n"
            "U1,first,,,,,,slow,sum\n"
            "U2,second,,,,,,quick,\n"
            "M1,second,,,,,,AD835,x^2\n"
            "S1,first,,,,,,ADG413,closed while node up is at 1 V\n"
            "V1,second,,,,,,a reference,node v\n");
}

TEST(PartsTable, TheSameAsJson) {
  const Json all = parts_json(one_of_each(), "name");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0], (Json{{"name", "R1"},
                          {"role", "input"},
                          {"section", "first"},
                          {"from", "in"},
                          {"to", "m"},
                          {"series", "E96"},
                          {"wanted_ohm", 4711.0},
                          {"realised_ohm", 4750.0}}));
  EXPECT_EQ(all[1].at("realised_f"), 2.2e-9);
  EXPECT_EQ(all[1].at("wanted_f"), 2.1e-9);
  EXPECT_FALSE(all[1].contains("wanted_ohm"));
  EXPECT_FALSE(all[2].contains("realised_ohm") || all[2].contains("realised_f"));
}

}  // namespace
}  // namespace bodesmith::schematic
