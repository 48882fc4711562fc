#include "fpaa/gains/gain_schedule.hpp"
#include "base/documents/json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>

#include "base/error.hpp"
#include "fpaa/fake_board.hpp"
#include "run_program.hpp"
#include "texts.hpp"

namespace bodesmith::fpaa {
namespace {

using enum Disturbance::Branch;
using ::testing::HasSubstr;

constexpr const char* kGainProject = R"(
const an_Byte an_apiAddress1[2] = { 0x01, 0x02 };
const an_Byte an_FPAA1_PrimaryConfigInfo[] = { 0xD5, 0xB7, 0x20, 0x01, 0x00, 0x01, 0xC1 };
const an_Byte an_FPAA2_PrimaryConfigInfo[] = { 0xD5, 0xB7, 0x20, 0x01, 0x00, 0x02, 0xC1 };
extern const an_apiCapacitor an_FPAA1_Up_Capacitor[4] = {
  /* Cin */ { 3, 7, }, /* Cout */ { 3, 6, }, /* aCin */ { 3, 5, }, /* aCout */ { 3, 4, }, };
extern const an_apiCapacitor an_FPAA1_Sum_Capacitor[3] = {
  /* Cin1 */ { 5, 7, }, /* Cin2 */ { 5, 6, }, /* Cout */ { 5, 5, }, };
extern const an_apiCapacitor an_FPAA2_Down_Capacitor[2] = {
  /* Cin */ { 3, 7, }, /* Cout */ { 3, 6, }, };
)";

Disturbance rated(std::vector<double> up, std::vector<double> down) {
  Disturbance out;
  out.ascending = {0.355, -0.465, 0.11};
  out.descending = {-0.03, 0.39, -0.36};
  out.rate.frequency = {Hertz{1.0}, Hertz{10.0}, Hertz{100.0}};
  out.rate.ascending = std::move(up);
  out.rate.descending = std::move(down);
  return out;
}

GainBranch gain_branch(Disturbance::Branch branch, const std::string& place) {
  const ApiProject project = parse_api_code(kGainProject, "A.c");
  return {branch, parse_gain_place(place, &project, "--x"), 1.0};
}

GainSchedule both_branches() {
  return make_gain_schedule(rated({1.0, 0.97, 0.9}, {1.0, 1.06, 1.17}),
                            {gain_branch(ascending, "FPAA1.Up"), gain_branch(descending, "FPAA2.Down")}, 0.2,
                            "d.json");
}

/// The memory of a chip after a stream.
using GainMemory = std::map<MemoryPlace, int>;
void take_stream(GainMemory& memory, const ConfigStream& stream) {
  for (const ConfigBlock& block : stream.blocks) {
    for (std::size_t i = 0; i < block.data.size(); ++i)
      memory[{block.bank, block.byte + static_cast<int>(i)}] = block.data[i];
  }
}

TEST(GainSchedule, EveryFrequencyIsServedWithinHalfAStep) {
  const Disturbance d = rated({1.0, 0.97, 0.9}, {1.0, 1.06, 1.17});
  GainBranch up = gain_branch(ascending, "FPAA1.Up"), down = gain_branch(descending, "FPAA2.Down");
  const auto worst_gain = [&](double up_at_one, double down_at_one) {
    up.at_one = up_at_one;
    down.at_one = down_at_one;
    const GainSchedule schedule = make_gain_schedule(d, {up, down}, 0.2, "d.json");
    double worst = 0.0;
    for (double f = 0.5; f < 200.0; f *= 1.013) {
      // The nearest in log f, held beyond the ends.
      const auto serves = [&](const GainSet& one) { return f < one.to.value; };
      const GainSet& set = *std::find_if(schedule.sets.begin(), schedule.sets.end(), serves);
      worst =
          std::max({worst, std::abs(set.gains[0].realised() / up_at_one - d.rate_gain(ascending, Hertz{f})),
                    std::abs(set.gains[1].realised() / down_at_one - d.rate_gain(descending, Hertz{f}))});
    }
    std::size_t longest = 0;
    for (const GainSet& set : schedule.sets) longest = std::max(longest, schedule.packets(set).size());
    EXPECT_DOUBLE_EQ(schedule.update_s, 10.0 * static_cast<double>(longest) / 57600.0);
    EXPECT_GT(schedule.max_gain_error_percent, 0.8 * 100.0 * worst / 1.17);
    // The seed's greatest d is about 0.09 of the stroke.
    EXPECT_LT(schedule.max_tracking_error_percent, 0.12 * 100.0 * worst);
    return worst;
  };
  // Near 1 the ratios are 1/255 apart and half of that is the error; the better gains at 1 leave half a step.
  EXPECT_NEAR(worst_gain(1.0, 1.0), 0.5 / 255 + 1e-3, 5e-4);
  const GainSchedule plain = both_branches();
  for (const GainBranch& b : plain.branches) EXPECT_LT(b.better_error_percent, 0.05);
  EXPECT_LT(worst_gain(plain.branches[0].better_at_one, plain.branches[1].better_at_one), 1.7e-3);
}

TEST(GainSchedule, SetsShareWhatLiesBetweenThemAndAreKeptALittleLonger) {
  const std::vector<GainSet> sets = both_branches().sets;
  ASSERT_GT(sets.size(), 2U);
  EXPECT_EQ(sets.front().from.value, 0.0);
  EXPECT_EQ(sets.front().keep_from.value, 0.0);
  EXPECT_GT(sets.back().to.value, 1e9);
  for (std::size_t i = 0; i + 1 < sets.size(); ++i) {
    const double low = std::log(sets[i].frequency.value), high = std::log(sets[i + 1].frequency.value);
    EXPECT_NEAR(std::log(sets[i].to.value), 0.5 * (low + high), 1e-9);
    EXPECT_NEAR(std::log(sets[i + 1].from.value), 0.5 * (low + high), 1e-9);
    EXPECT_NEAR(std::log(sets[i].keep_to.value), 0.25 * low + 0.75 * high, 1e-9);
    EXPECT_NEAR(std::log(sets[i + 1].keep_from.value), 0.75 * low + 0.25 * high, 1e-9);
  }
}

TEST(GainSchedule, WhatRatiosDoNotMakeIsSaid) {
  const auto refusal = [](const char* place) -> std::string {
    try {
      make_gain_schedule(rated({1.0, 2.0, 3.0}, {1.0, 1.0, 1.0}), {gain_branch(ascending, place)}, 0.2,
                         "d.json");
    } catch (const DesignError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("FPAA1.Sum:Cin1/200"), HasSubstr("1 to 255 units over 200 do not make"));
  EXPECT_EQ(refusal("FPAA1.Up"), "");
}

TEST(GainSchedule, StreamsSetBothCapacitorsOfBothChips) {
  const GainSchedule schedule = both_branches();
  const GainSet& set = schedule.sets.back();
  ASSERT_EQ(set.streams.size(), 2u);
  GainMemory one;
  const ConfigStream first = decode(set.streams.at(1), "one");
  EXPECT_EQ(first.address1, 1);
  EXPECT_EQ(first.control, ConfigStream::kEndExecute);
  ASSERT_EQ(first.blocks.size(), 1u) << "four neighbouring bytes are one block";
  take_stream(one, first);
  EXPECT_EQ((one[{3, 7}]), set.gains[0].over);
  EXPECT_EQ((one[{3, 5}]), set.gains[0].over) << "the pair that is there twice";
  EXPECT_EQ((one[{3, 6}]), set.gains[0].under);
  EXPECT_NEAR((static_cast<double>(one[{3, 7}]) / one[{3, 6}]), 0.9, 1e-12);
  GainMemory two;
  take_stream(two, decode(set.streams.at(2), "two"));
  EXPECT_NEAR((static_cast<double>(two[{3, 7}]) / two[{3, 6}]), 1.17, 1e-4);
  EXPECT_EQ(from_packets(schedule.packets(set), "p").size(), 2u);
}

TEST(GainSchedule, ASharedFeedbackCapacitorStays) {
  const GainBranch up = gain_branch(ascending, "FPAA1.Sum:Cin1/200");
  const GainBranch down = gain_branch(descending, "FPAA1.Sum:Cin2/200");
  const GainSchedule schedule =
      make_gain_schedule(rated({1.0, 0.97, 0.9}, {1.0, 1.06, 1.17}), {up, down}, 0.2, "d.json");
  const GainSet& set = schedule.sets.back();
  GainMemory memory;
  take_stream(memory, decode(set.streams.at(1), "one"));
  EXPECT_EQ(memory, (GainMemory{{{5, 7}, 180}, {{5, 6}, 234}}));
  // With Cout left to each the two would set it to different values.
  EXPECT_THROW(make_gain_schedule(rated({1, 1, 0.9}, {1, 1, 1.1}),
                                  {gain_branch(ascending, "FPAA1.Sum:Cin1/Cout"),
                                   gain_branch(descending, "FPAA1.Sum:Cin2/Cout")},
                                  0.2, "d.json"),
               DesignError);
}

TEST(GainSchedule, OneBranchAloneAndKnownAddresses) {
  const GainBranch down{descending, parse_gain_place("3:9.7/9.6", nullptr, "--x"), 2.0};
  const GainSchedule schedule =
      make_gain_schedule(rated({1, 1, 1}, {1.0, 1.06, 1.17}), {down}, 0.2, "d.json");
  EXPECT_EQ(schedule.branches.size(), 1u);
  EXPECT_EQ(schedule.branches[0].place.address1, 3);
  GainMemory memory;
  take_stream(memory, decode(schedule.sets.front().streams.at(3), "one"));
  EXPECT_EQ((memory[{9, 7}]), 2 * (memory[{9, 6}]));
  EXPECT_EQ((memory[{9, 7}]), 254) << "the largest of the equal ratios";
}

TEST(GainSchedule, RefusesWhatCannotBe) {
  const auto refused = [](const Disturbance& d, const std::vector<GainBranch>& branches,
                          double step_percent) {
    try {
      make_gain_schedule(d, branches, step_percent, "d.json");
    } catch (const DesignError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const GainBranch up = gain_branch(ascending, "FPAA1.Up");
  EXPECT_THAT(refused(rated({1, 1, 1}, {1, 1, 1}), {up}, 0.2), HasSubstr("no branch changes"));
  EXPECT_THAT(refused(rated({1, 1, 1}, {1, 1, 1.2}), {up}, 0.2), HasSubstr("--descending"));
  EXPECT_THAT(refused(rated({1, 1, -1}, {1, 1, 1}), {up}, 0.2), HasSubstr("gain of -"));
  EXPECT_THAT(refused(rated({1, 1, 400}, {1, 1, 1}), {up}, 0.2), HasSubstr("gain of 400 at 100 Hz"));
  EXPECT_THAT(refused(rated({1, 1, 0.5}, {1, 1, 1}), {up}, 1e-4), HasSubstr("larger step"));
  const auto place = [](const std::string& text) {
    try {
      gain_branch(ascending, text);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_THAT(place("FPAA1.None"), HasSubstr("FPAA1.Up"));
  EXPECT_THAT(place("FPAA1.Up:C9/Cout"), HasSubstr("no capacitor C9"));
  EXPECT_THAT(place("FPAA1.Up:Cin/300"), HasSubstr("no capacitor 300"));
  EXPECT_THAT(place("1:3.7"), HasSubstr("expected CHIP.CAM"));
  EXPECT_THAT(place("1:3.32/3.6"), HasSubstr("byte 0 to 31"));
  EXPECT_THAT(place("Up"), HasSubstr("expected CHIP.CAM"));
  EXPECT_THAT(place(""), HasSubstr("expected CHIP.CAM"));
}

/// The host's loops, against a board that is a pseudo-terminal.
class GainHost : public ::testing::Test {
 protected:
  void SetUp() override {
    write_file(folder_ / "gain_host.c", gain_host_c(schedule_, "d.json"));
    write_file(folder_ / "gain_host.py", gain_host_python(schedule_, "d.json"));
    const ProgramResult made =
        run_shell("cc -std=c99 -O1 -Wall -Wextra -Werror -o '" + (folder_ / "host").string() + "' '" +
                  (folder_ / "gain_host.c").string() + "' -lm");
    ASSERT_EQ(made.status, 0) << made.err;
  }
  std::string c_host() const { return "'" + (folder_ / "host").string() + "'"; }
  std::string python_host() const { return "python3 '" + (folder_ / "gain_host.py").string() + "'"; }
  ProgramResult host(const std::string& program, const std::string& arguments,
                     const std::string& input) const {
    write_file(folder_ / "input", input);
    return run_shell(program + " " + arguments + " < '" + (folder_ / "input").string() + "'");
  }
  /// |Cin/Cout| of both branches after every packet of both chips.
  static std::vector<std::pair<double, double>> gains_on(FakeBoard& board) {
    std::map<int, GainMemory> chips;
    std::vector<std::pair<double, double>> out;
    for (const Packet& packet : board.packets()) {
      const ConfigStream stream = decode(packet.bytes, "line");
      EXPECT_FALSE(packet.primary);
      take_stream(chips[stream.address1], stream);
      if (stream.address1 != 2) continue;
      const auto gain = [&](int chip) {
        return static_cast<double>(chips[chip][{3, 7}]) / chips[chip][{3, 6}];
      };
      out.emplace_back(gain(1), gain(2));
    }
    return out;
  }

  TemporaryFolder folder_;
  GainSchedule schedule_ = both_branches();
};

TEST_F(GainHost, SendsTheSetThatServesEachFrequency) {
  const Disturbance d = rated({1.0, 0.97, 0.9}, {1.0, 1.06, 1.17});
  const std::vector<double> frequencies = {1.0, 10.0, 37.0, 37.01, 100.0, 5000.0};
  std::string input = "# hertz\n";
  for (const double f : frequencies) input += std::to_string(f) + "\n";
  for (const std::string& program : {c_host(), python_host()}) {
    FakeBoard board({.chips = 2});
    const ProgramResult run = host(program, board.name(), input);
    EXPECT_EQ(run.status, 0) << run.err;
    const auto gains = gains_on(board);
    // 37.01 Hz is served by the set of 37 Hz, 5 kHz by that of 100 Hz.
    ASSERT_EQ(gains.size(), 4u) << program << run.out;
    const double sent[] = {1.0, 10.0, 37.0, 100.0};
    for (std::size_t i = 0; i < gains.size(); ++i) {
      EXPECT_NEAR(gains[i].first, d.rate_gain(ascending, Hertz{sent[i]}), 3e-3) << program << sent[i];
      EXPECT_NEAR(gains[i].second, d.rate_gain(descending, Hertz{sent[i]}), 3e-3) << program << sent[i];
    }
  }
}

TEST_F(GainHost, MeasuresThePeriodOfATriangle) {
  // 20 Hz for ten periods, then 80 Hz at a quarter of the amplitude about another middle.
  std::string input;
  for (int i = 0; i < 5000; ++i) {
    const double t = i / 10000.0;
    const double phase = std::fmod(20.0 * t, 1.0);
    input += std::to_string(phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase) + "\n";
  }
  for (int i = 0; i < 6000; ++i) {
    const double phase = std::fmod(80.0 * (i + 0.3) / 10000.0, 1.0);
    input += std::to_string(0.1 + 0.5 * (phase < 0.5 ? phase : 1.0 - phase)) + "\n";
  }
  for (const std::string& program : {c_host(), python_host()}) {
    const ProgramResult run = host(program, "- --samples 10000", input);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, ::testing::StartsWith("20 Hz: set ")) << program;
    EXPECT_THAT(run.out, HasSubstr("\n80 Hz: set ")) << program << run.out;
  }
}

TEST_F(GainHost, DoesNotToggleBetweenTwoSets) {
  const std::size_t at = schedule_.sets.size() / 2;
  const double edge = schedule_.sets[at].to.value;
  std::string input;
  for (int i = 0; i < 50; ++i) input += std::to_string(edge * (i % 2 == 0 ? 0.9999 : 1.0001)) + "\n";
  for (const std::string& program : {c_host(), python_host()}) {
    const ProgramResult run = host(program, "-", input);
    EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 1) << program << run.out;
  }
}

TEST_F(GainHost, SaysWhatIsWrong) {
  for (const std::string& program : {c_host(), python_host()}) {
    EXPECT_EQ(host(program, "", "1\n").status, 2) << program;
    EXPECT_EQ(host(program, "/dev/null", "1\n").status, 2) << program;
    EXPECT_EQ(host(program, "- --samples 0", "1\n").status, 2) << program;
    const ProgramResult run = host(program, "-", "1\nabc\n");
    EXPECT_EQ(run.status, 2) << program;
    EXPECT_THAT(run.err, HasSubstr("line 2")) << program;
    EXPECT_EQ(host(program, "-", "-5\n").status, 2) << program;
    EXPECT_EQ(host(program, "-", "nan\n").status, 2) << program;
  }
  FakeBoard refusing({.chips = 2, .refuses = true});
  const ProgramResult run = host(c_host(), refusing.name(), "10\n");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("does not answer"));
}

TEST(GainSchedule, SaysEveryPlaceAndEverySet) {
  GainSchedule schedule;
  schedule.branches = {{ascending, {"FPAA1.Up", 3, {{2, 5}}, {{2, 6}}}, 1.25, 1.5, 0.125},
                       {descending, {"C", 4, {{7, 8}, {9, 10}}, {}, 77}, 2.0}};
  schedule.sets = {{{10.0}, {}, {}, {}, {}, {{1.625, 3, 2}, {0.375, 1, 2}}, {}}};
  schedule.max_ratio_error_percent = 0.5;
  schedule.max_gain_error_percent = 0.75;
  schedule.max_tracking_error_percent = 0.25;
  schedule.update_s = 0.125;
  EXPECT_EQ(schedule.to_json(), parsed(R"({"branches": [
      {"branch": "ascending", "place": "FPAA1.Up", "address1": 3, "over": [{"bank": 2, "byte": 5}],
       "under": [{"bank": 2, "byte": 6}], "gain_at_one": 1.25, "better_gain_at_one": 1.5, "better_ratio_error_percent": 0.125},
      {"branch": "descending", "place": "C", "address1": 4, "over": [{"bank": 7, "byte": 8}, {"bank": 9, "byte": 10}],
       "under": [], "gain_at_one": 2, "under_units": 77}],
    "sets": [{"frequency_hz": 10, "gains": [
      {"branch": "ascending", "wanted": 1.625, "realised": 1.5, "over_units": 3, "under_units": 2},
      {"branch": "descending", "wanted": 0.375, "realised": 0.5, "over_units": 1, "under_units": 2}]}],
    "error": {"max_ratio_percent": 0.5, "max_gain_percent": 0.75, "max_tracking_percent": 0.25}, "update_s": 0.125})"));
  EXPECT_EQ(schedule.csv(),
            "frequency_hz,ascending_gain,ascending_realised,ascending_over_units,ascending_under_units,"
            "descending_gain,descending_realised,descending_over_units,descending_under_units\n"
            "10.0,1.625,1.5,3,2,0.375,0.5,1,2\n");
}

}  // namespace
}  // namespace bodesmith::fpaa
