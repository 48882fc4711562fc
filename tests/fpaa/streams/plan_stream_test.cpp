// From a plan to its bytes and back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "fpaa/an231_streams.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/seed_sections.hpp"
#include "fpaa/streams/board_networks.hpp"
#include "fpaa/streams/netlist.hpp"
#include "fpaa/streams/plan_stream.hpp"
#include "fpaa/streams/stream_check.hpp"
#include "fpaa/streams/stream_file.hpp"
#include "fpaa/streams/stream_output.hpp"
#include "kept_text.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

PlacedCam placed(const char* name, const char* cam, const char* option, int cab, int clock, double clock_hz,
                 std::vector<Capacitor> capacitors, std::size_t inputs = 1) {
  PlacedCam out;
  out.name = name;
  out.cam = cam_registry().find(cam);
  out.option = option;
  out.cab = cab;
  out.clock_index = clock;
  out.clock_a = {clock_hz};
  out.capacitors = std::move(capacitors);
  out.z.numerators.resize(inputs);
  out.find_z();
  return out;
}

/// A constant path and two slow low passes, each at its own clock, and a two-op-amp stage, into a sum; the second
/// chip inverts.
Plan parallel_plan() {
  Plan plan;
  plan.board = "an231k04-quad4";
  plan.error.band = {{1.0}, {5000.0}};
  ChipPlan one;
  one.chip = 1;
  one.master_clock = {16e6};
  one.clocks.clocks = {{1, 64}, {1, 320}, {1, 192}};
  one.cams = {
      placed("Low1", "FilterBilinear", "Low Pass", 1, 1, 50e3, {{"Cin", 5}, {"Cout", 3}, {"Cint", 250}}),
      placed("Low2", "FilterBilinear", "Low Pass", 1, 2, 16e6 / 192, {{"Cin", 7}, {"Cout", 4}, {"Cint", 90}}),
      placed("Second", "BiquadStage", "Low Q", 2, 0, 250e3,
             {{"C1", 3}, {"Cp", 9}, {"Cpp", 2}, {"C2", 5}, {"C3", 7}, {"C4", 60}, {"CA", 200}, {"CB", 150}}),
      placed(
          "Sum1", "SumInv", "", 4, 0, 250e3,
          {{"Cin1", 11}, {"aCin1", 4}, {"Cin2", 20}, {"Cin3", 15}, {"Cin4", 9}, {"Cout", 12}, {"aCout", 2}},
          4),
  };
  ChipPlan two;
  two.chip = 2;
  two.master_clock = {16e6};
  two.clocks.clocks = {{1, 64}};
  two.cams = {placed("Sign", "GainInv", "", 1, 0, 250e3, {{"Cin", 3}, {"Cout", 2}})};
  plan.chips = {one, two};
  plan.wires = {
      {"chip1.in1", "chip1.Low1"},       {"chip1.in1", "chip1.Low2"},     {"chip1.in1", "chip1.Second"},
      {"chip1.in1", "chip1.Sum1", 1},    {"chip1.Low1", "chip1.Sum1", 2}, {"chip1.Low2", "chip1.Sum1", 3},
      {"chip1.Second", "chip1.Sum1", 4}, {"chip1.Sum1", "chip1.out1"},    {"chip1.out1", "chip2.in1"},
      {"chip2.in1", "chip2.Sign"},       {"chip2.Sign", "chip2.out1"}};
  return plan;
}

TEST(An231Plan, TheSeedsPlanFitsOneChipAndDoesWhatItSays) {
  const Plan& plan = seed_plan();
  const PlanStreams streams = value_or_throw(plan_streams(plan));
  ASSERT_EQ(streams.chips.size(), 1u);
  EXPECT_LT(check_streams(plan, streams), 1e-7);
  // 2 kHz needs a system divisor, which no public stream has.
  EXPECT_THAT(streams.warnings.front(), HasSubstr("No public stream does that"));
  const MemoryImage& memory = streams.chips[0].memory;
  EXPECT_EQ(memory.at(0, 0x09), memory.at(0, 0x0A));
  EXPECT_NE(memory.at(0, 0x09), 0);
}

TEST(An231Plan, ParallelPathsOfSeveralClocksOverTwoChips) {
  const Plan plan = parallel_plan();
  const PlanStreams streams = value_or_throw(plan_streams(plan));
  ASSERT_EQ(streams.chips.size(), 2u);
  EXPECT_LT(check_streams(plan, streams), 1e-7);
  const BoardCircuit board = read_back(plan, streams);
  ASSERT_EQ(board.links.size(), 1u);
  for (const ChipCircuit& chip : board.chips) {
    EXPECT_THAT(chip.problems, IsEmpty());
    EXPECT_THAT(chip.unexplained, IsEmpty());
  }
  // The files bring the same memory back.
  OutputSet files = stream_files(plan, streams, "plan.json");
  EXPECT_EQ(files.paths().size(), 5u);
  expect_kept("fpaa/kept_streams.txt", digests(files) + first_power_on(plan, streams) + board_text(board) +
                                           board_json(board).dump() + "\n" +
                                           stream_json(streams, 0.25).dump() + "\n");
  // One clock below 31.4 kHz is none here: no warning of it.
  for (const std::string& w : streams.warnings) EXPECT_THAT(w, Not(HasSubstr("No public stream")));
}

/// The bytes said in words are the plan: clocks, capacitors, op-amps, cells, and of each stage its z-transfer.
TEST(An231Plan, WhatItsBytesAreSaidToMakeIsThePlan) {
  const Plan plan = parallel_plan();
  const PlanStreams streams = value_or_throw(plan_streams(plan));
  const BoardCircuit board = read_back(plan, streams);
  const Json json = board_json(board);
  const std::string text = board_text(board);
  const Json stream = stream_json(streams, 0.25);
  std::size_t stage_at = 0;
  ASSERT_EQ(json["chips"].size(), plan.chips.size());
  for (std::size_t i = 0; i < plan.chips.size(); ++i) {
    const ChipPlan& chip = plan.chips[i];
    const Json& said = json["chips"][i];
    EXPECT_EQ(said["chip"], chip.chip);
    EXPECT_EQ(said["problems"].size() + said["unexplained"].size(), 0u);
    EXPECT_EQ(said["clocks_hz"]["sys1_hz"], 16e6);
    std::map<int, std::multiset<int>> units, found;
    std::map<int, int> opamps;
    for (const PlacedCam& cam : chip.cams) {
      const StageSwitches stage = *cam.cam->switches(cam);
      for (const StageCapacitor& c : stage.capacitors) units[cam.cab].insert(static_cast<int>(c.units));
      opamps[cam.cab] += static_cast<int>(stage.opamps.size());
      EXPECT_NEAR(said["clocks_hz"]["clock" + std::to_string(cam.clock_index) + "_hz"].get<double>(),
                  cam.clock_a.value, 1e-6);
    }
    for (const Json& cab : said["cabs"]) {
      int on = 0;
      for (const Json& amp : cab["opamps"]) on += amp["on"] ? 1 : 0;
      EXPECT_EQ(on, opamps[cab["cab"]]) << cab["cab"];
      for (const Json& c : cab["capacitors"]) found[cab["cab"]].insert(c["units"].get<int>());
    }
    std::erase_if(found, [](const auto& one) { return one.second.empty(); });
    EXPECT_EQ(found, units);
    const auto pins = streams.pins_of(chip.chip);
    EXPECT_EQ(stream["chips"][i]["pins"], Json(pins));
    EXPECT_EQ(said["io_cells"].size(), pins.size());
    for (const Json& cell : said["io_cells"]) {
      const bool output = pins.at("out1") == cell["cell"];
      EXPECT_EQ(cell["mode"], output ? "output, bypass" : "input, bypass");
      EXPECT_EQ(cell.contains("driven_by"), output);
    }
  }
  // Stages of one op-amp.
  for (const Json& stage : json["stages"]) {
    const auto of = [&](const char* key, const Json& list, RadPerSecond w, double clock) {
      Complex sum = 0.0;
      for (std::size_t k = 0; k < list.size(); ++k)
        sum += list[k].get<double>() * std::polar(1.0, -static_cast<double>(k) * w.value / clock);
      EXPECT_FALSE(list.empty()) << key;
      return sum;
    };
    ASSERT_TRUE(stage.contains("z_denominator")) << stage;
    EXPECT_FALSE(stage["half_period_output"].get<bool>());
    EXPECT_EQ(stage["inputs"].size(), stage["z_numerators"].size());
    const double clock = stage["clock_hz"];
    const RadPerSecond w{0.3 * clock};
    for (const ChipPlan& chip : plan.chips) {
      for (const PlacedCam& cam : chip.cams) {
        const std::string out = "chip" + std::to_string(chip.chip) + ".CAB" + std::to_string(cam.cab) + ".op";
        const std::string amp = stage["output"].get<std::string>();
        if (!amp.starts_with(out) || std::abs(cam.clock_a.value - clock) > 1e-6 ||
            cam.cam->switches(cam)->opamps.size() > 1)
          continue;
        ++stage_at;
        EXPECT_THAT(text, HasSubstr(amp + " at "));
        double nearest = 1e300;
        for (const Json& numerator : stage["z_numerators"])
          nearest = std::min(nearest, std::abs(of("above", numerator, w, clock) /
                                                   of("below", stage["z_denominator"], w, clock) -
                                               cam.z.response(w, cam.clock_a, 1)));
        EXPECT_LT(nearest, 1e-9) << cam.name;
      }
    }
  }
  EXPECT_EQ(stage_at, 4u);
  EXPECT_THAT(text, HasSubstr("chip2.IO"));
  EXPECT_EQ(stream["largest_difference_percent"], 0.25);
}

TEST(An231Plan, OneInputMayFeedTwoChips) {
  Plan plan = parallel_plan();
  plan.chips[1].cams[0] = placed("Sum2", "SumInv", "", 1, 0, 250e3,
                                 {{"Cin1", 3}, {"aCin1", 3}, {"Cin2", 5}, {"Cout", 4}, {"aCout", 4}}, 2);
  plan.wires.resize(plan.wires.size() - 2);
  plan.wires.insert(plan.wires.end(), {{"chip2.in1", "chip2.Sum2", 1},
                                       {"chip1.in1", "chip2.in2"},
                                       {"chip2.in2", "chip2.Sum2", 2},
                                       {"chip2.Sum2", "chip2.out1"}});
  const PlanStreams streams = value_or_throw(plan_streams(plan));
  EXPECT_LT(check_streams(plan, streams), 1e-7);
  EXPECT_THAT(first_power_on(plan, streams), HasSubstr("chip 1 IO1 to chip 2 IO2"));
}

TEST(An231Plan, AWrongUnitIsSeenByBytesAndResponse) {
  const Plan plan = parallel_plan();
  PlanStreams streams = value_or_throw(plan_streams(plan));
  std::vector<ChipImage> chips;
  for (const auto& chip : streams.chips) chips.push_back({chip.chip, chip.memory, {}});
  EXPECT_THAT(value_or_throw(memory_differences(plan, chips)), IsEmpty());
  const int was = chips[0].memory.at(3, 7);
  chips[0].memory.set(3, 7, was + 1);
  const auto differences = value_or_throw(memory_differences(plan, chips));
  ASSERT_EQ(differences.size(), 1u);
  EXPECT_THAT(differences[0], HasSubstr("C1 of CAB 1"));
  streams.chips[0].memory.set(3, 7, was + 1);
  EXPECT_THROW(check_streams(plan, streams), DesignError);
}

TEST(An231Plan, RefusesWhatCannotBeAStream) {
  Plan plan = parallel_plan();
  plan.chips[1].cams[0].cam = cam_registry().find("TransferFunction");
  auto outcome = plan_streams(plan);
  ASSERT_NE(refusal_of(outcome), nullptr);
  EXPECT_THAT(refusal_of(outcome)->reason, HasSubstr("has no look-up table"));
  plan.chips[1].cams[0].requested = LookupTable{}.values();
  outcome = plan_streams(plan);
  ASSERT_NE(refusal_of(outcome), nullptr);
  EXPECT_THAT(refusal_of(outcome)->reason, HasSubstr("known for one a chip, in CAB 4 at Clock 3"));
  plan.chips[1].cams[0].cam = cam_registry().find("Multiplier");
  outcome = plan_streams(plan);
  ASSERT_NE(refusal_of(outcome), nullptr);
  EXPECT_THAT(refusal_of(outcome)->reason, HasSubstr("switches are not publicly known"));
  plan = parallel_plan();
  plan.chips[0].cams[1].clock_a = {16e6 / 193};
  outcome = plan_streams(plan);
  ASSERT_NE(refusal_of(outcome), nullptr);
  EXPECT_THAT(refusal_of(outcome)->reason, HasSubstr("no one system divisor makes all of its clocks"));
  plan = parallel_plan();
  plan.chips[0].cams[0].capacitors[1].units = 0;
  outcome = plan_streams(plan);
  ASSERT_NE(refusal_of(outcome), nullptr);
  EXPECT_THAT(refusal_of(outcome)->reason, HasSubstr("Cout of chip1.Low1 is 0 units"));
}

TEST(An231Plan, FirstPowerOnHasTheReadingsOfThisDesign) {
  const Plan plan = parallel_plan();
  const PlanStreams streams = value_or_throw(plan_streams(plan));
  const std::string text = first_power_on(plan, streams);
  EXPECT_THAT(text, HasSubstr("not tried on silicon"));
  EXPECT_THAT(text, HasSubstr("chip 1 IO3 to chip 2 IO1"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  const std::complex<double> h = SwitchedBoard(plan).gain(Hertz{1.0}.rad_s());
  EXPECT_THAT(text, HasSubstr("Test tone 0.5 V peak (differential; the first node clips at 3 V)"));
  Plan early = plan;
  early.max_input_v = 1.2;
  EXPECT_THAT(first_power_on(early, streams), HasSubstr("Test tone 0.3 V"));
  EXPECT_THAT(text, HasSubstr("| 1 | " + std::to_string(20.0 * std::log10(std::abs(h))).substr(0, 4)));
}

}  // namespace
}  // namespace bodesmith::fpaa::an231
