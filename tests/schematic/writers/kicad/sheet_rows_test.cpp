#include "schematic/writers/kicad/sheet_rows.hpp"

#include <gtest/gtest.h>

#include <tuple>

namespace bodesmith::kicad {
namespace {

Group of_cells(int count, int width, int height) {
  Cell cell;
  cell.drawing.reach({width, height});
  Group out;
  out.cells.assign(static_cast<std::size_t>(count), cell);
  return out;
}

// A4 has 205 steps between its margins and 121 above its title: four cells of 44 and a gap stand side by side.
TEST(Rows, AGroupTooWideForOneRowGoesOnBelow) {
  const Paper& a4 = kPapers[0];
  for (const auto& [cells, height, fits] : {std::tuple(4, 118, true),
                                            {4, 119, false},
                                            {5, 57, true},
                                            {8, 57, true},
                                            {9, 57, false},
                                            {9, 37, true}}) {
    Rows rows(a4);
    EXPECT_EQ(rows.add(of_cells(cells, 44, height)), fits) << cells << " " << height;
  }
  Rows rows(a4);
  EXPECT_FALSE(rows.add(of_cells(1, 206, 10)));
  EXPECT_TRUE(rows.empty());
  EXPECT_TRUE(rows.add(of_cells(1, 205, 10)));
  EXPECT_FALSE(rows.empty());
}

}  // namespace
}  // namespace bodesmith::kicad
