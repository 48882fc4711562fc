// What is named is of the records: neither of the order in which they are given nor of digits that no converter has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

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

TEST(Laws, namesDependNeitherOnOrderNorUnitsNorABillionthOfTheOutput) {
  for (const auto& missing : kMissing) {
    SCOPED_TRACE(missing);
    const auto r = records_of(kBase + missing);
    const auto usual = told(r.train, r.holdout);
    EXPECT_EQ(told({r.train[1], r.train[0]}, r.holdout), usual);
    EXPECT_EQ(told_of_other(r, 1e3, 1e3, 0.0, 0), usual);
    EXPECT_EQ(told_of_other(r, 1.0, 1.0, 1e-9, 10), usual);
  }
}

}  // namespace
}  // namespace laws
