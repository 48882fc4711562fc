#include "simulate/signal_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/documents/json.hpp"
#include "signal/csv.hpp"
#include "signal/period.hpp"
#include "simulate/references.hpp"

namespace bodesmith::simulate {
namespace {

TEST(SignalStudy, TriangleHasItsClosedForm) {
  // Samples of a triangle of height 1: line k, odd, is 4/(N sin(pi k/N))^2; the continuous triangle's
  // distortion is sqrt(pi^4/96 - 1).
  ReferenceSpec spec;
  spec.frequency = Hertz{10.0};
  spec.step_s = 1e-4;
  const TimeRecord r = make_reference(spec);
  const auto study = study_signals(r.u, r.u, 0.0, r.step_s, std::nullopt);
  ASSERT_TRUE(study.repetition);
  EXPECT_EQ(study.repetition->samples, 1000u);
  EXPECT_DOUBLE_EQ(study.fundamental->value, 10.0);
  for (std::size_t k = 1; k < 500; ++k) {
    const double root = 1000.0 * std::sin(std::numbers::pi * static_cast<double>(k) / 1000.0);
    EXPECT_NEAR(study.u.amplitude[k], k % 2 == 1 ? 4.0 / (root * root) : 0.0, 1e-13) << k;
  }
  EXPECT_NEAR(*study.y_distortion_percent, 100.0 * std::sqrt(std::pow(std::numbers::pi, 4) / 96.0 - 1.0),
              1e-3);
  EXPECT_EQ(study.loops.size(), 10u);
  const std::string table = loops_csv(study, "u");
  EXPECT_EQ(table.substr(table.find('\n') + 1, 2), "1,") << table.substr(0, 80);
  EXPECT_NE(table.find("\n10,"), std::string::npos);
  EXPECT_NEAR(study.loops.front().height_percent, 0.0, 1e-9);
}

TEST(SignalStudy, RepetitionIsFoundOrNot) {
  ReferenceSpec spec;
  spec.kind = "sine";
  spec.frequency = Hertz{3.0};  // 333.33 samples
  spec.duration_s = 2.5;
  const TimeRecord r = make_reference(spec);
  EXPECT_EQ(find_repetition(r.u)->samples, 1000u);
  const auto known = repetition_of(Hertz{3.0}, 1e-3, r.size());
  EXPECT_EQ(known->samples, 1000u);
  EXPECT_EQ(known->cycles, 3u);
  EXPECT_FALSE(repetition_of(Hertz{3.0}, 1e-3, 900));
  EXPECT_FALSE(repetition_of(Hertz{std::sqrt(2.0)}, 1e-3, 2000));
  EXPECT_FALSE(find_repetition(std::vector<double>(50, 1.0)));
  spec.kind = "chirp";
  EXPECT_FALSE(find_repetition(make_reference(spec).u));
  // The sine itself, by its third line of the repetition.
  const auto study = study_signals(r.u, r.u, 0.0, r.step_s, Hertz{3.0});
  EXPECT_NEAR(study.u.amplitude[3], 0.5, 1e-12);
  EXPECT_LT(*study.u_distortion_percent, 1e-9);
  // Phases count from the record's own zero of time, whichever period is looked at.
  const std::span<const double> shorter(r.u.data(), 2401);
  const auto other = study_signals(shorter, shorter, 0.0, r.step_s, Hertz{3.0});
  EXPECT_NEAR(std::remainder(other.u.phase_deg[3] - study.u.phase_deg[3], 360.0), 0.0, 1e-6);
}

TEST(Loop, PlayHasItsParallelogram) {
  // y = max/min play of width 0.2 under a triangle 0..1: 0.9 - ... the branches are u - 0.1 and u + 0.1 where
  // play is taken up.
  std::vector<double> u, y;
  double last = 0.0;
  for (int i = 0; i <= 4000; ++i) {
    const double part = (i % 2000) / 1000.0;
    u.push_back(part < 1.0 ? part : 2.0 - part);
    last = std::clamp(last, u.back() - 0.1, u.back() + 0.1);
    y.push_back(last);
  }
  const auto study = study_signals(u, y, 0.0, 1e-3, std::nullopt);
  ASSERT_EQ(study.loops.size(), 2u);
  const Loop& loop = study.loops.back();
  EXPECT_NEAR(loop.height, 0.2, 1e-12);
  EXPECT_NEAR(loop.height_percent, 100.0 * 0.2 / 0.8, 1e-9);
  ASSERT_EQ(loop.u.size(), 101u);
  for (std::size_t i = 0; i < loop.u.size(); ++i) {
    EXPECT_NEAR(loop.ascending[i], std::max(loop.u[i] - 0.1, 0.1), 1e-9) << i;
    EXPECT_NEAR(loop.descending[i], std::min(loop.u[i] + 0.1, 0.9), 1e-9) << i;
  }
  EXPECT_EQ(hysteresis_loop(std::vector<double>{0, 1, 2}, std::vector<double>{0, 1, 2}).u.size(), 0u);
}

// 60 Hz at 4 kHz repeats after 200 samples and three cycles: the fundamental is 60 Hz, not 20 Hz.
TEST(SignalStudy, KnowsTheCyclesWithinARepetition) {
  std::vector<double> sine, triangle, two;
  for (int i = 0; i < 1000; ++i) {
    const double cycles = 60.0 * i / 4000.0, part = cycles - std::floor(cycles);
    sine.push_back(std::sin(2.0 * std::numbers::pi * cycles));
    triangle.push_back(part < 0.5 ? 2.0 * part : 2.0 - 2.0 * part);
    two.push_back(sine.back() + 0.5 * std::sin(2.0 * std::numbers::pi * cycles * 5.0 / 3.0));
  }
  for (const auto& u : {sine, triangle}) {
    const SignalStudy study = study_signals(u, u, 0.0, 1.0 / 4000.0, std::nullopt);
    ASSERT_TRUE(study.fundamental);
    EXPECT_NEAR(study.fundamental->value, 60.0, 1e-9);
    EXPECT_EQ(study.repetition->samples, 200u);
    EXPECT_EQ(study.repetition->cycles, 3u);
  }
  EXPECT_LT(*study_signals(sine, sine, 0.0, 1.0 / 4000.0, std::nullopt).u_distortion_percent, 1e-9);
  // 60 and 100 Hz together have 20 Hz in common.
  EXPECT_NEAR(study_signals(two, two, 0.0, 1.0 / 4000.0, std::nullopt).fundamental->value, 20.0, 1e-9);
}

/// Harmonics count from the fundamental, whatever the cycles of a repetition and the unit of the input.
TEST(SignalStudy, TablesCountInHarmonicsOfTheFundamental) {
  std::vector<double> u, y;
  for (int i = 0; i < 1000; ++i) {
    const double turn = 2.0 * std::numbers::pi * 60.0 * i / 4000.0;
    u.push_back(5e-3 * std::sin(turn) + 2e-3);
    y.push_back(3.0 * std::cos(turn) - 0.3 * std::cos(3.0 * turn) + 0.1 * std::sin(5.0 * turn));
  }
  const SignalStudy study = study_signals(u, y, 0.0, 1.0 / 4000.0, std::nullopt);
  const Json json = spectra_json(study, "drive");
  ASSERT_EQ(json["harmonics"].size(), 10u);
  const double wanted[] = {3.0, 0.0, 0.3, 0.0, 0.1, 0.0};
  for (std::size_t k = 1; k <= 6; ++k) {
    const Json& one = json["harmonics"][k - 1];
    EXPECT_EQ(one["harmonic"], k);
    EXPECT_NEAR(one["frequency_hz"], 60.0 * static_cast<double>(k), 1e-9);
    EXPECT_NEAR(one["y_amplitude"], wanted[k - 1], 1e-12) << k;
    EXPECT_NEAR(one["drive_amplitude"], k == 1 ? 5e-3 : 0.0, 1e-12) << k;
  }
  EXPECT_NEAR(json["thd_percent"]["y"], 100.0 * std::hypot(0.3, 0.1) / 3.0, 1e-9);
  const Csv lines = Csv::parse(spectra_csv(study, "drive"), "spectra.csv");
  ASSERT_EQ(lines.rows(), 101u);
  for (std::size_t i = 0; i < lines.rows(); ++i) {
    EXPECT_NEAR(lines.column("frequency_hz")[i], 20.0 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(lines.column("harmonic")[i], static_cast<double>(i) / 3.0, 1e-9);
  }
  EXPECT_NEAR(lines.column("y_amplitude")[9], 0.3, 1e-12);
  // Loops, in another unit: as high, over levels as many times larger.
  std::vector<double> large = u;
  for (double& one : large) one *= 1e3;
  const Loop loop = hysteresis_loop(u, y), same = hysteresis_loop(large, y);
  ASSERT_EQ(loop.u.size(), 101u);
  for (std::size_t i = 0; i < loop.u.size(); ++i) {
    EXPECT_NEAR(1e3 * loop.u[i], same.u[i], 1e-9);
    EXPECT_NEAR(loop.ascending[i], same.ascending[i], 1e-9);
    EXPECT_NEAR(loop.descending[i], same.descending[i], 1e-9);
  }
  const Json loops = loops_json(study);
  EXPECT_EQ(loops["periods"], study.loops.size());
  double most = 0.0;
  for (const Loop& one : study.loops) most = std::max(most, one.height_percent);
  EXPECT_EQ(loops["largest_height_percent"], most);
  EXPECT_GT(most, 0.0);
  const Csv table = Csv::parse(loops_csv(study, "drive"), "loops.csv");
  EXPECT_EQ(table.rows(), 101u * study.loops.size());
  EXPECT_EQ(table.column("period").back(), static_cast<double>(study.loops.size()));
}

TEST(Loop, LagOfASineIsAnEllipse) {
  // u = cos, y = cos(. - p): height 2 sin p over a range of 2.
  const double p = 0.3;
  std::vector<double> u, y;
  for (int i = 0; i <= 20000; ++i) {
    u.push_back(std::cos(2.0 * std::numbers::pi * i / 20000.0));
    y.push_back(std::cos(2.0 * std::numbers::pi * i / 20000.0 - p));
  }
  const Loop loop = hysteresis_loop(u, y);
  EXPECT_NEAR(loop.height, 2.0 * std::sin(p), 1e-6);
  for (std::size_t i = 0; i < loop.u.size(); ++i) {
    const double half = std::sin(p) * std::sqrt(1.0 - loop.u[i] * loop.u[i]);
    EXPECT_NEAR(loop.descending[i], loop.u[i] * std::cos(p) + half, 1e-6);  // u falls first, y is late
    EXPECT_NEAR(loop.ascending[i], loop.u[i] * std::cos(p) - half, 1e-6);
  }
}

}  // namespace
}  // namespace bodesmith::simulate
