// The oracle is a stage simulated here, in steps a fiftieth of a sample: nothing of the program takes part in it.
#include "identify/stage_disturbance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "base/error.hpp"

namespace bodesmith::identify {
namespace {

using Cubic = std::array<double, 3>;

double value_of(const Cubic& a, double x) {
  return x * (a[0] + x * (a[1] + x * a[2]));
}

struct DrawnStage {
  Cubic ascending{-0.35, 0.64, -0.29};
  Cubic descending{0.24, -0.08, -0.16};
  double offset = 1.2;
  double stroke = 6.92;
  double low = -10.0;  ///< of the drive
  double high = 90.0;
  double amplifier_s = 0.0;
  double delay_s = 0.0;
  double noise = 0.0;  ///< of the stroke

  /// Turns of a triangle (or of a raised cosine) at f, from the lower end to `alpha` of the full stroke.
  TimeRecord record(double f, double gain_up, double gain_down, int turns, double alpha = 1.0,
                    double at_alpha = 1.0, unsigned seed = 1, bool sine = false) const {
    const int per_turn = 400;
    const int fine = 50;
    const double step = 1.0 / (f * per_turn);
    TimeRecord out;
    out.file = "record";
    out.step_s = step;
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal(0.0, 1.0);
    const auto drive = [&](double t) {
      const double phase = t * f - std::floor(t * f);
      return alpha * (sine ? 0.5 - 0.5 * std::cos(2.0 * M_PI * phase)
                           : (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase));
    };
    double v = 0.0;
    std::vector<double> heard;  // at the fine steps
    const double h = step / fine;
    for (int i = 0; i <= turns * per_turn * fine; ++i) {
      const double x = drive(i * h);
      const double before = v;
      v = amplifier_s > 0.0 ? v + (x - v) * (1.0 - std::exp(-h / amplifier_s)) : x;
      const bool up = v >= before;
      const double s = v / alpha;
      heard.push_back(v + at_alpha *
                              (up ? gain_up * value_of(ascending, s) : gain_down * value_of(descending, s)));
    }
    for (int i = 0; i <= turns * per_turn; ++i) {
      const double t = i * step;
      out.u.push_back(low + (high - low) * drive(t));
      const double at = std::clamp((t - delay_s) / h, 0.0, static_cast<double>(heard.size() - 1));
      const auto k = static_cast<std::size_t>(at);
      const double part = at - static_cast<double>(k);
      const double y = heard[k] + (part > 0.0 ? part * (heard[k + 1] - heard[k]) : 0.0);
      out.y.push_back(offset + stroke * (y + noise * normal(engine)));
    }
    return out;
  }
};

const std::array<double, 5> kFrequencies{1, 10, 20, 60, 100};
const std::array<double, 5> kGains{1, 1.06, 1.1, 1.04, 1.17};

std::vector<TimeRecord> records_of(const DrawnStage& stage, int turns = 7, bool sine = false) {
  std::vector<TimeRecord> out;
  for (std::size_t i = 0; i < 5; ++i) {
    out.push_back(
        stage.record(kFrequencies[i], 1.0, kGains[i], turns, 1.0, 1.0, static_cast<unsigned>(i), sine));
    out.back().file = "record" + std::to_string(i);
  }
  return out;
}

TEST(StageDisturbance, FindsPolynomialsAndGainsOfAStageWithoutLag) {
  const DrawnStage stage;
  const StageDisturbance found = identify_disturbance(records_of(stage));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.disturbance.ascending[i], stage.ascending[i], 1e-3);
    EXPECT_NEAR(found.disturbance.descending[i], stage.descending[i], 1e-3);
  }
  EXPECT_EQ(found.reading, GainReading::basis_times_gain);
  EXPECT_NEAR(found.loops[0].offset, stage.offset, 1e-3);
  EXPECT_NEAR(found.loops[0].stroke, stage.stroke, 1e-3);
  EXPECT_NEAR(found.input(stage.high), 1.0, 1e-9);
  ASSERT_EQ(found.disturbance.rate.frequency.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(found.disturbance.rate.frequency[i].value, kFrequencies[i]);
    EXPECT_EQ(found.disturbance.rate.ascending[i], 1.0);
    EXPECT_NEAR(found.disturbance.rate.descending[i], kGains[i], 2e-3);
    EXPECT_LT(found.loops[i].gain_percent, 0.02);
    EXPECT_EQ(found.loops[i].held_out_turns, 3u);
  }
  EXPECT_EQ(found.varying(), Disturbance::Branch::descending);
  EXPECT_TRUE(found.disturbance.amplitude.alpha.empty()) << "no stroke was a short one";
}

TEST(StageDisturbance, TwoRecordsOfAFrequencyAreOneGainTheirMean) {
  const DrawnStage stage;
  std::vector<TimeRecord> records = records_of(stage);
  records.push_back(stage.record(20.0, 1.0, 1.14, 7));
  const StageDisturbance found = identify_disturbance(records);
  ASSERT_EQ(found.disturbance.rate.frequency.size(), 5u);
  EXPECT_NEAR(found.disturbance.rate.descending[2], 0.5 * (1.1 + 1.14), 2e-3);
  EXPECT_NEAR(found.disturbance.rate.descending[3], 1.04, 2e-3);
}

// A controller takes one stroke for all frequencies: half a percent is told, less is not.
TEST(StageDisturbance, AStrokeThatChangesWithTheFrequencyIsSaid) {
  const DrawnStage stage;
  for (const double more : {0.002, 0.01}) {
    std::vector<TimeRecord> records = records_of(stage);
    for (double& y : records.back().y) y = stage.offset + (1.0 + more) * (y - stage.offset);
    const std::vector<std::string> notes = identify_disturbance(records).notes;
    const auto said = [&](const std::string& begin) {
      return std::any_of(notes.begin(), notes.end(),
                         [&](const std::string& one) { return one.starts_with(begin); });
    };
    EXPECT_EQ(said("the stroke at"), more > 0.005);
    EXPECT_EQ(said("the stroke at 100 Hz is 1.01 times that at 1 Hz"), more > 0.005);
  }
}

TEST(StageDisturbance, TellsLagAndNoiseFromTheLoop) {
  DrawnStage stage;
  stage.noise = 0.002;
  const auto check = [&](StageLag::Kind kind, double seconds) {
    const StageDisturbance found = identify_disturbance(records_of(stage));
    EXPECT_EQ(found.lag.kind, kind) << to_string(found.lag.kind);
    EXPECT_NEAR(found.lag.seconds, seconds, 0.03 * seconds + 2e-6);
    for (std::size_t i = 1; i < 5; ++i) {
      const LoopAtFrequency& loop = found.loops[i];
      EXPECT_NEAR(loop.gain[1], kGains[i], 4.0 * loop.deviation[1] + 2e-3) << loop.frequency.value;
      EXPECT_NEAR(loop.gain[0], 1.0, 4.0 * loop.deviation[0] + 2e-3) << loop.frequency.value;
      EXPECT_LT(loop.deviation[1], 0.01);
      // What is left is the noise.
      EXPECT_NEAR(loop.gain_percent, 0.2, 0.02);
    }
  };
  stage.delay_s = 2e-4;
  check(StageLag::Kind::delay, 2e-4);
  stage.delay_s = 0.0;
  stage.amplifier_s = 3e-4;
  check(StageLag::Kind::amplifier, 3e-4);
}

TEST(StageDisturbance, DeviationsOfTheGainsAreWhatDrawnRecordsShow) {
  DrawnStage stage;
  stage.noise = 0.01;
  double scatter = 0.0, said = 0.0;
  const int draws = 40;
  for (int k = 0; k < draws; ++k) {
    const auto seed = static_cast<unsigned>(2 * k + 10);
    const std::vector<TimeRecord> records{stage.record(1.0, 1.0, 1.0, 3, 1.0, 1.0, seed),
                                          stage.record(20.0, 1.0, 1.1, 3, 1.0, 1.0, seed + 1)};
    const LoopAtFrequency loop = identify_disturbance(records).loops[1];
    scatter += (loop.gain[1] - 1.1) * (loop.gain[1] - 1.1) / draws;
    said += loop.deviation[1] * loop.deviation[1] / draws;
  }
  // 40 draws know a variance to within a quarter.
  EXPECT_GT(said / scatter, 0.5);
  EXPECT_LT(said / scatter, 2.0);
}

// Ends of short strokes beside the full one's line, and a stroke that falls with the frequency, are in no polynomial: said.
TEST(StageDisturbance, SaysWhatOneLineForAllStrokesLeaves) {
  DrawnStage stage, weaker, shorter;
  stage.noise = weaker.noise = shorter.noise = 5e-4;
  weaker.stroke *= 0.7;
  shorter.stroke *= 0.98;
  const auto said = [](const StageDisturbance& study, const char* what) {
    return std::any_of(study.notes.begin(), study.notes.end(),
                       [&](const std::string& note) { return note.find(what) != std::string::npos; });
  };
  std::vector<TimeRecord> records = records_of(stage, 5);
  records.push_back(stage.record(1.0, 1.0, 1.0, 2, 0.5, 0.4));
  const StageDisturbance plain = identify_disturbance(records);
  EXPECT_LT(plain.strokes[0].line_percent, 0.1);
  EXPECT_NEAR(plain.strokes[0].slope, 1.0, 2e-3);
  EXPECT_FALSE(said(plain, "one line") || said(plain, "the stroke at"));
  records.back() = weaker.record(1.0, 1.0, 1.0, 2, 0.5, 0.4);
  records[4] = shorter.record(100.0, 1.0, 1.17, 5);
  const StageDisturbance other = identify_disturbance(records);
  EXPECT_NEAR(other.strokes[0].slope, 0.7, 5e-3);
  // .3 of half a stroke at its end, a triangle: over the square root of three.
  EXPECT_NEAR(other.strokes[0].line_percent, 100.0 * 0.3 * 0.5 / std::sqrt(3.0), 1.0);
  EXPECT_TRUE(said(other, "a stroke of 0.5 goes 0.7 times as far"));
  EXPECT_NEAR(other.loops[4].stroke / other.loops[0].stroke, 0.98, 1e-3);
  EXPECT_TRUE(said(other, "the stroke at 100 Hz is 0."));
}

TEST(StageDisturbance, FindsAmplitudeGainsOfShortStrokes) {
  const DrawnStage stage;
  std::vector<TimeRecord> records = records_of(stage, 3);
  records.push_back(stage.record(1.0, 1.0, 1.0, 2, 0.5, 0.4));
  records.push_back(stage.record(20.0, 1.0, 1.1, 2, 0.25, 0.15));
  const StageDisturbance found = identify_disturbance(records);
  const auto& table = found.disturbance.amplitude;
  ASSERT_EQ(table.alpha.size(), 3u);
  EXPECT_NEAR(table.alpha[0], 0.25, 1e-6);
  EXPECT_NEAR(table.alpha[1], 0.5, 1e-6);
  EXPECT_EQ(table.alpha[2], 1.0);
  EXPECT_NEAR(table.ascending[0], 0.15, 2e-3);
  EXPECT_NEAR(table.descending[0], 0.15, 2e-3);
  EXPECT_NEAR(table.ascending[1], 0.4, 2e-3);
  EXPECT_EQ(table.ascending[2], 1.0);

  // A fifth of the stroke higher up: its gains are the same, and where they were read is said.
  const auto said = [](const StageDisturbance& study) {
    return std::any_of(study.notes.begin(), study.notes.end(), [](const std::string& note) {
      return note.find("do not begin at the lower end") != std::string::npos;
    });
  };
  EXPECT_FALSE(said(found));
  for (double& u : records.back().u) u += 0.2 * (stage.high - stage.low);
  for (double& y : records.back().y) y += 0.2 * stage.stroke;
  const StageDisturbance shifted = identify_disturbance(records);
  EXPECT_TRUE(said(shifted));
  EXPECT_NEAR(shifted.disturbance.amplitude.ascending[0], 0.15, 2e-3);
}

TEST(StageDisturbance, TakesSinesAndAnOutputThatFalls) {
  DrawnStage stage;
  stage.stroke = -3.0;
  const StageDisturbance found = identify_disturbance(records_of(stage, 5, true));
  EXPECT_NEAR(found.loops[0].stroke, -3.0, 1e-3);
  EXPECT_NEAR(found.disturbance.ascending[0], stage.ascending[0], 2e-3);
  EXPECT_NEAR(found.disturbance.rate.descending[4], 1.17, 3e-3);
  ASSERT_FALSE(found.notes.empty());
  EXPECT_NE(found.notes[0].find("falls as the input rises"), std::string::npos);
}

TEST(StageDisturbance, SaysSignsThatDoNotFit) {
  DrawnStage stage;
  DrawnStage other = stage;
  other.stroke = -stage.stroke;
  EXPECT_THROW(identify_disturbance(std::vector{stage.record(1, 1, 1, 3), other.record(10, 1, 1, 3)}),
               InputError);
  other = stage;
  std::swap(other.ascending, other.descending);
  EXPECT_THROW(identify_disturbance(std::vector{stage.record(1, 1, 1, 3), other.record(10, 1, 1, 3)}),
               InputError);
  const StageDisturbance clockwise = identify_disturbance(std::vector{other.record(1, 1, 1, 3)});
  EXPECT_NE(clockwise.notes.front().find("clockwise"), std::string::npos);
}

// 1/(1 + tau s) behind the stage: the loop's corners are round, and late.
TEST(StageDisturbance, TellsASensorsPole) {
  const DrawnStage stage;
  constexpr double kTau = 3e-4;
  std::vector<TimeRecord> records = records_of(stage);
  for (TimeRecord& record : records) {
    const double kept = std::exp(-record.step_s / kTau);
    const double mean = kTau / record.step_s * (1.0 - kept);
    double before = record.y[0], out = record.y[0];
    for (double& y : record.y) {
      out = kept * out + (mean - kept) * before + (1.0 - mean) * y;
      before = y;
      y = out;
    }
  }
  const StageDisturbance found = identify_disturbance(records);
  EXPECT_EQ(found.lag.kind, StageLag::Kind::sensor);
  EXPECT_NEAR(found.lag.seconds, kTau, 0.01 * kTau);
  EXPECT_LT(found.lag.deviation_s, 0.01 * kTau);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(found.loops[i].gain[1], kGains[i], 2e-3);
}

TEST(StageDisturbance, TheBranchThatVariesMayBeTheAscendingOne) {
  const DrawnStage stage;
  std::vector<TimeRecord> records;
  for (std::size_t i = 0; i < 5; ++i) records.push_back(stage.record(kFrequencies[i], kGains[i], 1.0, 3));
  const StageDisturbance found = identify_disturbance(records);
  EXPECT_EQ(found.varying(), Disturbance::Branch::ascending);
  EXPECT_NEAR(found.disturbance.rate.ascending[4], 1.17, 2e-3);
  EXPECT_EQ(found.disturbance.rate.descending[4], 1.0);
  EXPECT_NE(found.gains_csv().find("gains of the ascending branch"), std::string::npos);
  // Printed the other way round, the gains are those of the base over each record's.
  const StageDisturbance printed = identify_disturbance(records, GainReading::as_printed);
  EXPECT_EQ(printed.reading, GainReading::as_printed);
  EXPECT_NEAR(printed.disturbance.rate.ascending[4], 1.0 / 1.17, 2e-3);
}

TEST(StageDisturbance, StrokesOfOneLengthAreTheirMean) {
  DrawnStage stage;
  stage.noise = 2e-3;
  const std::vector<TimeRecord> shorts = {stage.record(1.0, 1.0, 1.0, 1, 0.5, 0.4, 21),
                                          stage.record(1.0, 1.0, 1.0, 1, 0.51, 0.46, 22),
                                          stage.record(1.0, 1.0, 1.0, 1, 0.505, 0.43, 23)};
  const auto with = [&](const std::vector<std::size_t>& which) {
    std::vector<TimeRecord> records = records_of(stage, 3);
    for (const std::size_t i : which) records.push_back(shorts[i]);
    return identify_disturbance(records).strokes;
  };
  const auto all = with({0, 1, 2});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].turns, 3u);
  double alpha = 0.0, gain = 0.0, square = 0.0, slope = 0.0, line = 0.0;
  for (const std::size_t i : {0U, 1U, 2U}) {
    const LoopAtStroke one = with({i}).at(0);
    alpha += one.alpha / 3.0;
    gain += one.gain[0] / 3.0;
    square += one.deviation[0] * one.deviation[0] / 9.0;
    slope += one.slope / 3.0;
    line += one.line_percent * one.line_percent / 3.0;
  }
  EXPECT_NEAR(all[0].alpha, alpha, 1e-9);
  EXPECT_NEAR(all[0].gain[0], gain, 1e-9);
  EXPECT_NEAR(all[0].deviation[0], std::sqrt(square), 1e-9);
  EXPECT_NEAR(all[0].slope, slope, 1e-9);
  EXPECT_NEAR(all[0].line_percent, std::sqrt(line), 1e-9);
  EXPECT_EQ(with({}).size(), 0u);
}

TEST(StageDisturbance, ADriftIsNoLoop) {
  const DrawnStage stage;
  std::vector<TimeRecord> records = records_of(stage);
  for (TimeRecord& record : records)
    for (std::size_t i = 0; i < record.size(); ++i)
      record.y[i] += 0.1 * stage.stroke * static_cast<double>(i) / static_cast<double>(record.size());
  const StageDisturbance found = identify_disturbance(records);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(found.loops[i].gain[1], kGains[i], 2e-3);
}

TEST(Turns, AreSharedOutAndTheFirstOfThreeIsLeft) {
  const DrawnStage stage;
  const auto shares = [&](int turns) {
    const TimeRecord record = stage.record(1.0, 1.0, 1.0, turns);
    const TurnedRecord one = cut_into_turns({&record, 1}).all.at(0);
    return std::pair(one.training.size(), one.held_out.size());
  };
  EXPECT_EQ(shares(1), std::pair(std::size_t{1}, std::size_t{0}));
  EXPECT_EQ(shares(2), std::pair(std::size_t{1}, std::size_t{1}));
  EXPECT_EQ(shares(3), std::pair(std::size_t{1}, std::size_t{1}));
  EXPECT_EQ(shares(4), std::pair(std::size_t{2}, std::size_t{1}));
  const std::vector<std::string> notes = identify_disturbance(std::vector{stage.record(1, 1, 1, 1)}).notes;
  const auto said = [&](const char* what) {
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& note) { return note.find(what) != std::string::npos; });
  };
  EXPECT_TRUE(said("hold nothing out") && said("records of one frequency"));
}

// Three digits where 2 of N samples cannot tell the difference.
TEST(Turns, AFrequencyIsAsItWasSet) {
  const DrawnStage stage;
  const auto frequency = [&](double f, int turns) {
    const TimeRecord record = stage.record(f, 1.0, 1.0, turns);
    return cut_into_turns({&record, 1}).all.at(0).frequency.value;
  };
  EXPECT_DOUBLE_EQ(frequency(33.33, 4), 33.3);  // 9e-4 of it; two of 1600 samples are 12.5e-4
  EXPECT_NEAR(frequency(33.33, 6), 33.33, 1e-9);
  EXPECT_DOUBLE_EQ(frequency(1234.0, 1), 1230.0);
}

TEST(Turns, WhatIsNoneIsSaid) {
  const DrawnStage stage;
  const TimeRecord good = stage.record(1.0, 1.0, 1.0, 3);
  TimeRecord higher = good, flat = good, straight = good, uneven = good;
  // One turn at four fifths of the other's speed.
  uneven.u.resize(400);
  for (int i = 0; i <= 500; ++i)
    uneven.u.push_back(stage.low + (stage.high - stage.low) * (1.0 - std::abs(1.0 - i / 250.0)));
  uneven.y = uneven.u;
  for (double& u : higher.u) u += 8.0;
  for (double& y : flat.y) y = 0.0;
  for (std::size_t i = 0; i < straight.size(); ++i) straight.y[i] = straight.u[i];
  const auto message = [](std::vector<TimeRecord> records) -> std::string {
    try {
      identify_disturbance(records);
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_EQ(message({good}), "taken");
  EXPECT_NE(message({good, higher}).find("its full stroke begins at -10, those of the other records at -6"),
            std::string::npos)
      << message({good, higher});
  EXPECT_NE(message({uneven}).find("its turns last from 1 s on and 1.125 s on the average"),
            std::string::npos)
      << message({uneven});
  EXPECT_NE(message({flat}).find("does not follow the input"), std::string::npos) << message({flat});
  EXPECT_NE(message({straight}).find("branch is a straight line"), std::string::npos) << message({straight});
}

TEST(StageDisturbance, RefusesRecordsWithoutATurn) {
  TimeRecord ramp;
  ramp.file = "ramp.csv";
  ramp.step_s = 1e-3;
  for (int i = 0; i < 100; ++i) {
    ramp.u.push_back(0.01 * i);
    ramp.y.push_back(0.01 * i);
  }
  EXPECT_THROW(identify_disturbance(std::vector{ramp}), InputError);
}

}  // namespace
}  // namespace bodesmith::identify
