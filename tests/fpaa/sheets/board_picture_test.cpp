#include "fpaa/sheets/board_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fpaa/seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(BoardPicture, ShowsEveryCamAndOneWireAnEdgeOfTheSignalPath) {
  Sections sections;
  for (int i = 0; i < 11; ++i) {
    sections.sections.push_back(Section::pole_zero(1.0, {50.0 + 20.0 * i}, {60.0 + 20.0 * i}));
  }
  PlanOptions options;
  options.clock = Hertz{2000.0};
  const Plan plan = plan_of(sections, options);
  ASSERT_EQ(plan.chips.size(), 2u);
  const std::string svg = board_picture_svg(plan);
  for (const PlacedCam* cam : plan.cams()) EXPECT_THAT(svg, ::testing::HasSubstr(">" + cam->name + "<"));
  EXPECT_EQ(count(svg, "class=\"wire\"") + count(svg, "class=\"link\""), static_cast<int>(plan.wires.size()));
  EXPECT_EQ(count(svg, "nan"), 0);
}

}  // namespace
}  // namespace bodesmith::fpaa
