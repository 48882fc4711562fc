// What is named is of the records: neither of the order in which they are given nor of digits that no converter has.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"

namespace laws {
namespace {

using namespace bodesmith;

constexpr double kStep_s = 1e-3;
const std::string kBase = "[[block]]\ntype = \"gain\"\ngain = 1.8\nfree = [\"gain\"]\n";

/// Two tones of this size, from rest.
std::vector<double> two_tones(double size, double hz) {
  std::vector<double> u;
  for (int i = 0; i < 600; ++i) {
    const double t = kStep_s * i;
    u.push_back(size * (0.6 * std::sin(2.0 * std::numbers::pi * hz * t) +
                        0.4 * std::sin(2.0 * std::numbers::pi * 2.7 * hz * t)));
  }
  return u;
}

/// Names, their ties and places, and the verdict.
std::string told(const std::vector<TimeRecord>& train, const TimeRecord& holdout) {
  const auto base = model_of(kBase);
  const auto d = gap::diagnose(base, gap::Study::of(train, {holdout}, base), {});
  std::string text = gap::to_string(d.verdict);
  for (const auto& step : d.steps) {
    text += "; " + step.effect + " " + step.placed;
    for (const auto& tie : step.tied_with) text += " or " + tie;
  }
  return text;
}

struct Records {
  std::vector<TimeRecord> train;
  TimeRecord holdout;
};
Records records_of(const std::string& truth) {
  return {{measured(truth, two_tones(0.5, 7.0), kStep_s, 0.01, 1),
           measured(truth, two_tones(1.0, 3.0), kStep_s, 0.01, 2)},
          measured(truth, two_tones(1.0, 4.0), kStep_s, 0.01, 3)};
}

const std::vector<std::string> kMissing = {
    "[[block]]\ntype = \"lowpass\"\ncorner_hz = 40.0\n",
    "[[block]]\ntype = \"slew_limit\"\nrate_per_s = 40.0\n",
    "[[block]]\ntype = \"saturation\"\nlower = -1.3\nupper = 9.0\n",
    "[[block]]\ntype = \"backlash\"\nwidth = 0.2\n",
};

/// The record with input, output and time in other units, and the output moved by so much of its range.
TimeRecord other(TimeRecord r, double volts, double seconds, double moved, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto [low, high] = std::minmax_element(r.y.begin(), r.y.end());
  const double range = *high - *low;
  for (double& y : r.y) y = volts * (y + moved * range * normal(random));
  for (double& u : r.u) u *= volts;
  r.step_s *= seconds;
  return r;
}
std::string told_of_other(const Records& r, double volts, double seconds, double moved, unsigned seed) {
  std::vector<TimeRecord> train;
  for (const auto& one : r.train) train.push_back(other(one, volts, seconds, moved, ++seed));
  return told(train, other(r.holdout, volts, seconds, moved, ++seed));
}

/// All at once: a law that fails is told by leaving out the others.
TEST(Laws, NamesDependNeitherOnOrderNorUnitsNorABillionthOfTheOutput) {
  for (const auto& missing : kMissing) {
    const auto r = records_of(kBase + missing);
    EXPECT_EQ(told_of_other({{r.train[1], r.train[0]}, r.holdout}, 1e3, 1e3, 1e-9, 10),
              told(r.train, r.holdout))
        << missing;
  }
}

}  // namespace
}  // namespace laws

// The same record in other units is the same record.
namespace {

using namespace bodesmith;

/// A Bouc-Wen loop of sharpness 1.5 behind a gain of 2, input and output in units of 1/scale.
TimeRecord loop_in_units(const char* file, unsigned seed, double scale) {
  double z = 0.0;
  double before = 0.0;
  return of_smoothed_noise(
      file, seed, 450, 1e-3,
      [&](int, double x, double e) {
        const double u = std::tanh(3.0 * x);
        for (int k = 0; k < 10; ++k) {
          const double du = 0.1 * (u - before);
          z += 0.3 * du - 2.0 * std::abs(du) * std::sqrt(std::abs(z)) * z -
               1.0 * du * std::pow(std::abs(z), 1.5);
        }
        before = u;
        return std::pair(scale * u, scale * (2.0 * (u - z) + 0.003 * e));
      },
      0.08);
}

gap::Diagnosis diagnosis_in_units(double scale) {
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.8\nfree = [\"gain\"]\n");
  const auto study =
      gap::Study::of({loop_in_units("train.csv", 1, scale)}, {loop_in_units("holdout.csv", 2, scale)}, base);
  return gap::diagnose(base, study, {});
}

TEST(Units, DecideNeitherNamesNorFigures) {
  const auto small = diagnosis_in_units(1e-6), large = diagnosis_in_units(1e6);
  ASSERT_FALSE(small.steps.empty());
  ASSERT_EQ(small.steps.size(), large.steps.size());
  EXPECT_EQ(small.steps[0].effect, "hysteresis");
  EXPECT_EQ(small.steps[0].effect, large.steps[0].effect);
  EXPECT_EQ(small.steps[0].placed, large.steps[0].placed);
  EXPECT_NEAR(1e12 * small.final.holdout_rms / large.final.holdout_rms, 1.0, 0.02);
}

TEST(Units, BeyondWhatCubesAllowAreRefusedInAWord) {
  for (const double scale : {1e150, 1e-150}) {
    try {
      diagnosis_in_units(scale);
      ADD_FAILURE() << scale;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("train.csv"), std::string::npos);
      EXPECT_NE(std::string(e.what()).find("another unit"), std::string::npos);
    }
  }
}

}  // namespace

// Asymmetric memory has a constant of its own and many unknowns: it explains alone what symmetric memory and an offset
// did. It is tried against its simpler relatives with one more name beside them.
namespace {

using namespace bodesmith;

constexpr double kNoise = 0.004;
constexpr double kOffset = -0.6;

chain::Chain curve() {
  return model_of(
      "[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, 0.37]\n"
      "[[block]]\ntype = \"gain\"\ngain = 1.4\nfree = [\"gain\"]\n");
}

/// Triangles whose heights are drawn.
std::vector<double> triangles(std::mt19937_64& random, int samples, int half_period) {
  std::uniform_real_distribution<double> height(0.25, 1.0);
  std::vector<double> u;
  double from = 0.0;
  double to = 1.0;
  for (int i = 0; i < samples; ++i) {
    const int k = i % half_period;
    if (k == 0 && i > 0) {
      from = to;
      to = (to > 0.0 ? -1.0 : 1.0) * height(random);
    }
    u.push_back(from + (to - from) * k / half_period);
  }
  return u;
}

/// The curve, and behind it plays beside the way through, and a constant.
TimeRecord record_of(unsigned seed) {
  constexpr std::array kRadius = {0.12, 0.35, 0.6, 0.9};
  constexpr std::array kWeight = {0.05, 0.06, 0.05, 0.06};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "loops.csv";
  r.step_s = 1e-3;
  r.u = triangles(random, 700, 50 + 15 * static_cast<int>(seed));
  std::array<double, 4> play{};
  for (double u : r.u) {
    const double v = 1.5 * (u + 0.37 * u * u);
    double y = v + kOffset;
    for (std::size_t k = 0; k < play.size(); ++k) {
      play[k] = std::clamp(play[k], v - kRadius[k], v + kRadius[k]);
      y += kWeight[k] * play[k];
    }
    r.y.push_back(y + kNoise * normal(random));
  }
  return r;
}

TEST(SimplerNames, SymmetricMemoryAndAnOffsetAreNotAsymmetricMemory) {
  const auto base = curve();
  const auto d = gap::diagnose(base, gap::Study::of({record_of(1), record_of(2)}, {record_of(3)}, base), {});
  std::set<std::string> names;
  for (const auto& step : d.steps) names.insert(step.effect);
  EXPECT_EQ(names, (std::set<std::string>{"hysteresis", "offset"}));
  EXPECT_LT(d.final.train_rms, 1.1 * kNoise);
}

}  // namespace
