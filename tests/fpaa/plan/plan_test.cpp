#include "fpaa/plan/plan.hpp"

#include <gtest/gtest.h>

#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/plan_graph.hpp"

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

/// Two CAMs A and B of one input and a sum S of two, all of one period's delay or none.
Plan wired(std::vector<Wire> wires, double delay_cycles = 0.0) {
  Plan plan;
  plan.board = "an231k04-quad4";
  ChipPlan& chip = plan.chips.emplace_back();
  chip.chip = 1;
  for (const char* name : {"A", "B", "S"}) {
    PlacedCam& cam = chip.cams.emplace_back();
    cam.name = name;
    const bool sum = *name == 'S';
    cam.cam = cam_registry().find(sum ? "SumInv" : "GainInv");
    if (sum) cam.option = "2 inputs";
    cam.clock_a = {1e6};
    cam.delay_cycles = delay_cycles;
    cam.z = {{{-1.0}}, {1.0}};
    if (sum) cam.z.numerators.push_back({-1.0});
  }
  plan.wires = std::move(wires);
  return plan;
}

TEST(PlanGraph, WiresThatMakeNoPlanAreSaid) {
  const std::vector<Wire> good = {{"chip1.in1", "chip1.A"},
                                  {"chip1.A", "chip1.B"},
                                  {"chip1.A", "chip1.S", 1},
                                  {"chip1.B", "chip1.S", 2},
                                  {"chip1.S", "chip1.out1"}};
  const auto said = [&](std::vector<Wire> more, std::size_t without = 99) {
    std::vector<Wire> wires = good;
    if (without < wires.size()) wires.erase(wires.begin() + static_cast<std::ptrdiff_t>(without));
    wires.insert(wires.end(), more.begin(), more.end());
    const auto graph = plan_graph(wired(wires));
    const Refusal* refusal = refusal_of(graph);
    return refusal == nullptr ? std::string("made") : refusal->reason;
  };
  EXPECT_EQ(said({}), "made");
  EXPECT_NE(said({{"chip1.X", "chip1.B", 2}}).find("a wire ends at 'chip1.X'"), std::string::npos);
  EXPECT_NE(said({{"chip1.A", "chip1.out1"}}).find("two wires lead to chip1.out1"), std::string::npos);
  EXPECT_NE(said({{"chip1.out2", "chip1.B"}}, 1).find("nothing is wired to chip1.out2"), std::string::npos);
  EXPECT_NE(said({{"chip1.out2", "chip1.out2"}, {"chip1.out2", "chip1.B"}}, 1).find("wired in a circle"),
            std::string::npos);
  EXPECT_NE(said({{"chip1.A", "chip1.B", 2}}).find("a wire leads to input 2 of chip1.B, which has 1"),
            std::string::npos);
  EXPECT_NE(said({{"chip1.A", "chip1.B", 0}}).find("a wire leads to input 0 of chip1.B"), std::string::npos);
  EXPECT_NE(said({{"chip1.A", "chip1.S", 2}}).find("two wires lead to input 2 of chip1.S"),
            std::string::npos);
  EXPECT_NE(said({{"chip1.S", "chip1.B"}}, 1).find("a loop without any delay"), std::string::npos);
  // The same loop with CAMs that read a period late.
  const PlanGraph looped = value_or_throw(plan_graph(wired({{"chip1.in1", "chip1.A"},
                                                            {"chip1.A", "chip1.S", 1},
                                                            {"chip1.B", "chip1.S", 2},
                                                            {"chip1.S", "chip1.B"},
                                                            {"chip1.S", "chip1.out1"}},
                                                           1.0)));
  EXPECT_TRUE(looped.looped);
  EXPECT_EQ(looped.nodes[2].delay, 32);
  EXPECT_EQ(looped.order, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(looped.output.node, 2u);
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
