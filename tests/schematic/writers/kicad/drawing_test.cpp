#include "schematic/writers/kicad/schematic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "schematic/writers/kicad/drawing.hpp"
#include "schematic/writers/kicad/netlist_groups.hpp"

namespace bodesmith::kicad {
namespace {

TEST(Value, IsWrittenAsOnAPartsList) {
  EXPECT_EQ(kicad_value(20500.0), "20.5k");
  EXPECT_EQ(kicad_value(1e-8), "10n");
  EXPECT_EQ(kicad_value(1e6), "1M");
  EXPECT_EQ(kicad_value(47e-12), "47p");
}

TEST(Drawing, NetsThatTouchAreAnError) {
  Drawing drawing;
  drawing.wire({0, 0}, {10, 0}, "a");
  EXPECT_NO_THROW(join_wires(drawing));
  drawing.wire({5, -5}, {5, 0}, "b");
  EXPECT_THROW(join_wires(drawing), std::logic_error);
  EXPECT_THROW(drawing.wire({0, 0}, {1, 1}, "a"), std::logic_error);
}

TEST(Drawing, ThreeEndsMakeAJunction) {
  Drawing drawing;
  drawing.wire({0, 0}, {10, 0}, "a");
  drawing.wire({5, -5}, {5, 0}, "a");
  const Joined joined = join_wires(drawing);
  EXPECT_EQ(joined.wires.size(), 3u);
  ASSERT_EQ(joined.junctions.size(), 1u);
  EXPECT_EQ(joined.junctions[0], (Point{5, 0}));
}

// A name and a value stand beside the body, neither on it nor on one another.
TEST(Drawing, TextsOfAPartStandNextToIt) {
  for (const auto kind : {schematic::Part::Kind::resistor, schematic::Part::Kind::capacitor}) {
    for (const bool horizontal : {true, false}) {
      Drawing drawing;
      schematic::Part part;
      part.kind = kind;
      drawing.part(part, {}, {0, 0}, horizontal, "a", "b");
      const Symbol& drawn = drawing.symbols.at(0);
      EXPECT_LT(drawn.reference_mm[1], drawn.value_mm[1] - 2.0) << "one over the other";
      for (const double* text : {drawn.reference_mm, drawn.value_mm})
        EXPECT_GT(std::abs(text[horizontal ? 1 : 0]), 1.8);
    }
  }
}

}  // namespace
}  // namespace bodesmith::kicad
