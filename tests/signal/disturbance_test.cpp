#include "signal/disturbance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

using Branch = Disturbance::Branch;

Disturbance seed() {
  return Disturbance::from_node(parse_json(R"({"schema": "bodesmith.disturbance/1",
    "ascending": [0.3546, -0.6433, 0.2887], "descending": [-0.2398, 0.0838, 0.156],
    "rate": {"frequency_hz": [1, 10, 100], "ascending": [1, 1, 1], "descending": [1, 1.06, 1.17]}})",
                                           "d.json"));
}

TEST(Disturbance, SeedPolynomialsVanishAtBothEnds) {
  const Disturbance d = seed();
  for (const Branch branch : {Branch::ascending, Branch::descending}) {
    EXPECT_EQ(d.value(branch, 0.0), 0.0);
    EXPECT_NEAR(d.value(branch, 1.0), 0.0, 1e-12);
  }
  // Fig. 3: the ascending disturbance bulges up to about 0.058, the descending one down to about -0.08.
  EXPECT_NEAR(d.value(Branch::ascending, 0.35), 0.0577, 2e-4);
  EXPECT_NEAR(d.value(Branch::descending, 0.6), -0.0800, 2e-4);
}

TEST(Disturbance, RateGainsAreLinearInLogFrequencyAndHeldAtTheEnds) {
  const Disturbance d = seed();
  EXPECT_DOUBLE_EQ(d.rate_gain(Branch::descending, Hertz{0.1}), 1.0);
  EXPECT_DOUBLE_EQ(d.rate_gain(Branch::descending, Hertz{10.0}), 1.06);
  EXPECT_NEAR(d.rate_gain(Branch::descending, Hertz{std::sqrt(1000.0)}), 0.5 * (1.06 + 1.17), 1e-12);
  EXPECT_DOUBLE_EQ(d.rate_gain(Branch::descending, Hertz{1e6}), 1.17);
  EXPECT_TRUE(d.is_static(Branch::ascending));
  EXPECT_FALSE(d.is_static(Branch::descending));
}

/// Below the shortest stroke of its table a gain is in proportion to the stroke; on a stroke the polynomial is of x over it.
TEST(Disturbance, GainsOfShortStrokesGoToZeroWithThem) {
  Disturbance d = seed();
  EXPECT_EQ(d.amplitude.at(Branch::ascending, 0.3), 0.3);
  d.amplitude.alpha = {0.2, 1.0};
  d.amplitude.ascending = {0.3, 1.0};
  d.amplitude.descending = {-0.1, 1.0};
  EXPECT_NEAR(d.amplitude.at(Branch::ascending, 0.05), 0.075, 1e-15);
  EXPECT_NEAR(d.amplitude.at(Branch::descending, 0.1), -0.05, 1e-15);
  EXPECT_NEAR(d.amplitude.at(Branch::ascending, 0.6), 0.65, 1e-15);
  const Disturbance short_stroke = d.at(0.6, Hertz{10.0});
  for (const double x : {0.1, 0.35, 0.6}) {
    EXPECT_NEAR(short_stroke.value(Branch::ascending, x), 0.65 * d.value(Branch::ascending, x / 0.6), 1e-15);
    EXPECT_NEAR(short_stroke.value(Branch::descending, x), 0.45 * 1.06 * d.value(Branch::descending, x / 0.6),
                1e-15);
  }
}

/// Everywhere between 0 and `to`, wherever the parabola d' has its vertex.
TEST(Disturbance, NowhereIsItSteeperThanItsSteepest) {
  Disturbance d;
  for (const double b : {-3.0, -0.9, 0.0, 0.4, 2.0}) {
    for (const double c : {-1.5, -0.3, 0.0, 0.2, 1.0}) {
      d.ascending = {0.4, b, c};
      for (const double to : {0.3, 1.0}) {
        double most = 0.0;
        for (int i = 0; i <= 4000; ++i) {
          const double x = to * i / 4000.0;
          most = std::max(most, std::abs(0.4 + 2.0 * b * x + 3.0 * c * x * x));
        }
        EXPECT_NEAR(d.steepest(Branch::ascending, to), most, 1e-6) << b << " " << c << " " << to;
      }
    }
  }
}

/// x' = x/s and d' = d/s of the same stage that goes no further than s: the paper's V.C.2.
TEST(Disturbance, UnderALoadItIsTheSameStageInUnitsOfItsNewStroke) {
  Disturbance d = seed();
  d.amplitude.alpha = {0.2, 0.4, 0.6, 1.0};
  d.amplitude.ascending = {0.12, 0.3, 0.55, 1.0};
  d.amplitude.descending = {0.1, 0.33, 0.52, 0.97};
  for (const double stroke : {0.8, 0.5}) {
    const Disturbance loaded = d.at_load(stroke);
    for (const double alpha : {0.2, 0.4, stroke}) {
      for (const Branch branch : kBranches) {
        for (const double x : {0.1, 0.35, 0.9})
          EXPECT_NEAR(loaded.at(alpha / stroke).value(branch, x * alpha / stroke),
                      d.at(alpha).value(branch, x * alpha) / stroke, 1e-14);
      }
    }
  }
}

TEST(Disturbance, ReadsBackWhatItWrites) {
  Json json = {{"schema", "bodesmith.disturbance/1"}};
  json.update(seed().to_json());
  const Disturbance back = Disturbance::from_node(parse_json(to_text(json), "d.json"));
  EXPECT_EQ(back.ascending, seed().ascending);
  EXPECT_EQ(back.rate.descending, seed().rate.descending);
}

TEST(Disturbance, RefusesTablesThatDoNotFit) {
  const auto read = [](const std::string& extra) {
    Disturbance::from_node(parse_json(
        R"({"schema": "bodesmith.disturbance/1", "ascending": [1,2,3], "descending": [1,2,3])" + extra + "}",
        "d.json"));
  };
  EXPECT_NO_THROW(read(""));
  EXPECT_THROW(read(R"(, "rate": {"frequency_hz": [1], "ascending": [1, 2], "descending": [1]})"),
               InputError);
  EXPECT_THROW(read(R"(, "rate": {"frequency_hz": [2, 1], "ascending": [1, 2], "descending": [1, 2]})"),
               InputError);
  EXPECT_THROW(read(R"(, "rate": {"frequency_hz": [], "ascending": [], "descending": []})"), InputError);
  EXPECT_THROW(read(R"(, "amplitude": {"alpha": [1]})"), InputError);
}

}  // namespace
}  // namespace bodesmith
