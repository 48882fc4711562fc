#include "fpaa/plan/plan.hpp"

#include <gtest/gtest.h>

namespace bodesmith::fpaa {
namespace {

TEST(Plan, EndsOfWires) {
  struct End {
    const char* text;
    int chip;
    const char* name;
    bool in, out;
  };
  for (const End& e : {End{"chip1.in1", 1, "in1", true, false},
                       {"chip12.out3", 12, "out3", false, true},
                       {"chip2.Section1a", 2, "Section1a", false, false},
                       {"chip1.in", 1, "in", false, false},
                       {"chip1.in2a", 1, "in2a", false, false},
                       {"chip1.input1", 1, "input1", false, false},
                       {"in1", 0, "in1", false, false},
                       {"chipX.in1", 0, "chipX.in1", false, false},
                       {"chip3.a.b", 3, "a.b", false, false}}) {
    const WireEnd got(e.text);
    EXPECT_EQ(got.chip, e.chip) << e.text;
    EXPECT_EQ(got.name, e.name) << e.text;
    EXPECT_EQ(got.is_input_pin(), e.in) << e.text;
    EXPECT_EQ(got.is_output_pin(), e.out) << e.text;
  }
}

TEST(Plan, ItsPinsAndTheShortestWayBetweenThem) {
  Plan plan;
  EXPECT_EQ(plan.input_pin(), "");
  EXPECT_EQ(plan.output_pin(), "");
  plan.wires = {{"chip1.A", "chip1.B"},      {"chip2.in1", "chip2.D"},  {"chip1.in1", "chip1.A"},
                {"chip1.B", "chip1.C"},      {"chip1.A", "chip1.C"},    {"chip1.C", "chip1.B", 2},
                {"chip1.out2", "chip2.in1"}, {"chip2.D", "chip2.out1"}, {"chip1.C", "chip1.out2"}};
  EXPECT_EQ(plan.input_pin(), "chip1.in1");
  EXPECT_EQ(plan.output_pin(), "chip2.out1");
  EXPECT_EQ(plan.signal_path(), (std::vector<std::string>{"chip1.in1", "chip1.A", "chip1.C", "chip1.out2",
                                                          "chip2.in1", "chip2.D", "chip2.out1"}));
  plan.wires.pop_back();
  EXPECT_TRUE(plan.signal_path().empty());
}

TEST(Plan, CamsClocksAndResourcesAreThoseOfAllChips) {
  Plan plan;
  for (int chip = 1; chip <= 2; ++chip) {
    ChipPlan& one = plan.chips.emplace_back();
    for (int i = 0; i < chip; ++i) {
      PlacedCam& cam = one.cams.emplace_back();
      cam.clock_a = {1000.0 * (chip + i)};
      cam.resources = {1, 2 + i, 0, 0, chip};
    }
  }
  EXPECT_EQ(plan.cams().size(), 3u);
  EXPECT_EQ(plan.cams()[2], &plan.chips[1].cams[1]);
  EXPECT_EQ(plan.clocks_hz(), (std::set<double>{1000.0, 2000.0, 3000.0}));
  EXPECT_EQ(plan.opamps(), 3);
  EXPECT_EQ(plan.chips[1].resources().capacitors, 5);
  EXPECT_EQ(plan.chips[1].resources().lookup_tables, 4);
  const Resources cab{2, 8, 1, 1, 1};
  EXPECT_TRUE(cab.fits_in(cab));
  for (int Resources::*one : {&Resources::opamps, &Resources::capacitors, &Resources::comparators,
                              &Resources::sars, &Resources::lookup_tables}) {
    Resources more = cab;
    ++(more.*one);
    EXPECT_FALSE(more.fits_in(cab));
    EXPECT_TRUE(cab.fits_in(more));
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
