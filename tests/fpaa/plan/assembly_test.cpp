#include "fpaa/plan/assembly.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

std::vector<Place> placed(const std::vector<PlaceNeed>& needs) {
  return value_or_throw(place(needs, an231k04_quad4()));
}

/// `count` CAMs of a group, of one op-amp and four of the eight capacitors of a CAB: two a CAB, eight a chip.
void add(std::vector<PlaceNeed>& to, int count, int group, std::optional<std::int64_t> divisor = {}) {
  for (int i = 0; i < count; ++i) to.push_back({{1, 4, 0, 0, 0}, group, divisor});
}

std::vector<int> chips_of(const std::vector<Place>& places) {
  std::vector<int> out;
  for (const Place& one : places) out.push_back(one.chip);
  return out;
}

TEST(Place, NoCabHoldsMoreThanItHas) {
  std::vector<PlaceNeed> needs;
  add(needs, 20, 0);
  std::map<std::pair<int, int>, Resources> used;
  const std::vector<Place> places = placed(needs);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_TRUE(places[i].cab >= 1 && places[i].cab <= kCabs);
    used[{places[i].chip, places[i].cab}] += needs[i].resources;
  }
  for (const auto& [where, sum] : used) EXPECT_TRUE(sum.fits_in(kPerCab)) << where.first << where.second;
  EXPECT_EQ(used.size(), 10u);  // the fullest first
}

TEST(Place, GroupsStayWholeOnThePresentChipTheNextOrOneBefore) {
  std::vector<PlaceNeed> needs;
  add(needs, 6, 0);
  add(needs, 4, 1);  // two are left on chip 1
  add(needs, 3, 2);  // four are left on chip 2
  add(needs, 2, 3);  // one there: chip 3 has room
  EXPECT_THAT(chips_of(placed(needs)), testing::ElementsAre(1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 3, 3));
  needs.clear();
  add(needs, 6, 0);
  for (int group = 1; group <= 3; ++group) add(needs, 8, group);
  add(needs, 2, 4);  // what is left is on the first
  EXPECT_EQ(chips_of(placed(needs)).back(), 1);
  add(needs, 1, 5);
  const auto refused = place(needs, an231k04_quad4());
  ASSERT_NE(refusal_of(refused), nullptr);
  EXPECT_THAT(refusal_of(refused)->reason,
              testing::HasSubstr("needs 33 CAMs with 33 op-amps, 32 of them fit on the 4 chips"));
  // A group that no chip holds is spread.
  needs.clear();
  add(needs, 9, 0);
  EXPECT_THAT(chips_of(placed(needs)), testing::ElementsAre(1, 1, 1, 1, 1, 1, 1, 1, 2));
}

TEST(Place, AChipHasSixClocksOneSystemDivisorAndOneTable) {
  std::vector<PlaceNeed> needs;
  for (std::int64_t k = 1; k <= 7; ++k) add(needs, 1, 0, 2 * k);
  add(needs, 1, 0, 4);  // a clock that is there
  EXPECT_THAT(chips_of(placed(needs)), testing::ElementsAre(1, 1, 1, 1, 1, 1, 2, 2));
  needs.clear();
  for (int i = 0; i < 2; ++i) needs.push_back({{1, 2, 0, 0, 1}, i, {}});
  EXPECT_THAT(chips_of(placed(needs)), testing::ElementsAre(1, 2));
}

TEST(Assembled, ClocksAreThoseOfTheCamsAndWiresJoinWhatIsRead) {
  const Board& board = an231k04_quad4();
  const auto cam = [&](const char* name, int chip, double total, std::vector<std::string> inputs) {
    WiredCam out;
    out.cam = cam_registry().find("FilterBilinear");
    out.name = name;
    out.chip = chip;
    out.clock_a = {board.master_clock.value / total};
    out.inputs = std::move(inputs);
    return out;
  };
  const std::vector<WiredCam> cams = {cam("A", 1, 400, {"in"}), cam("B", 1, 1600, {"A"}),
                                      cam("C", 1, 400, {"A"}),  cam("D", 2, 6000, {"B"}),
                                      cam("E", 2, 6000, {"D"}), cam("F", 3, 10, {"in"})};
  const Plan plan = assembled(cams, {"E"}, board, true);
  ASSERT_EQ(plan.chips.size(), 3u);
  for (const ChipPlan& chip : plan.chips) {
    for (const PlacedCam& one : chip.cams) {
      const auto k = static_cast<std::size_t>(one.clock_index);
      EXPECT_NEAR(chip.clocks.frequency(board.master_clock, k).value, one.clock_a.value,
                  1e-9 * one.clock_a.value)
          << one.name;
      EXPECT_TRUE(is_legal_divisor(chip.clocks.clocks[k].divisor));
    }
    // Two clocks are two (converters alone have each twice), the fastest first.
    EXPECT_EQ(chip.clocks.clocks.size(), chip.chip == 1 ? 2u : 1u);
  }
  EXPECT_GT(plan.chips[0].clocks.frequency(board.master_clock, 0),
            plan.chips[0].clocks.frequency(board.master_clock, 1));
  std::vector<std::string> wires;
  for (const Wire& wire : plan.wires)
    wires.push_back(wire.from + ">" + wire.to + "#" + std::to_string(wire.input));
  EXPECT_THAT(
      wires, testing::UnorderedElementsAre("chip1.in1>chip1.A#1", "chip1.A>chip1.B#1", "chip1.A>chip1.C#1",
                                           "chip1.B>chip1.out1#1", "chip1.out1>chip2.in1#1",
                                           "chip2.in1>chip2.D#1", "chip2.D>chip2.E#1", "chip2.E>chip2.out1#1",
                                           "chip3.in1>chip3.F#1", "chip1.in1>chip3.in1#1"));
  const std::vector<ChipSignals> signals = chip_signals(cams, {"E"}, board);
  EXPECT_THAT(signals[0].in, testing::ElementsAre("in"));
  EXPECT_THAT(signals[0].out, testing::ElementsAre("B"));
  EXPECT_EQ(signals[1].pins(), 2);
  EXPECT_EQ(signals[3].pins(), 0);
  EXPECT_EQ(assembled(cams, {"E"}, board, false).wires.size(), wires.size() - 1);
}

}  // namespace
}  // namespace bodesmith::fpaa
