// What is named is of the records: neither of the order in which they are given nor of digits that no converter has.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "made_model.hpp"
#include "made_record.hpp"

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

TEST(Laws, namesDoNotDependOnTheOrderOfTheRecords) {
  for (const auto& missing : kMissing) {
    const auto r = records_of(kBase + missing);
    EXPECT_EQ(told({r.train[0], r.train[1]}, r.holdout), told({r.train[1], r.train[0]}, r.holdout));
  }
}

}  // namespace
}  // namespace laws
