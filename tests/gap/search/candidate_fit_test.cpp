// A fit that got stuck at one place of a linear effect begins again with the values found at another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"

namespace {

using namespace bodesmith;

constexpr double kLooseStep = 7.7e-3;
constexpr double kLooseHz = 4.2;

chain::Chain stage_with_loops() {
  return model_of(
      "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0, 0.1, 0.4]\nw = [1.0, 0.06, 0.1]\n"
      "[[block]]\ntype = \"gain\"\ngain = 15.0\nfree = [\"gain\"]\n"
      "[[block]]\ntype = \"resonator\"\ngain = 1.0\nnatural_frequency_hz = 11.2\ndamping_ratio = 0.0125\n"
      "free = [\"natural_frequency_hz\", \"damping_ratio\"]\n");
}

struct Mode {
  double natural_hz;
  double damping;
  double y = 0.0;
  double v = 0.0;
  double step(double u, double h) {
    const double w = 2.0 * std::numbers::pi * natural_hz;
    v += 0.5 * h * (w * w * (u - y) - 2.0 * damping * w * v);
    y += h * v;
    v += 0.5 * h * (w * w * (u - y) - 2.0 * damping * w * v);
    return y;
  }
};

/// Treads of a staircase through two plays, a loose part of 4.2 Hz and the stage's own mode.
TimeRecord shaken(unsigned seed) {
  constexpr int kFiner = 50;
  constexpr int kTread = 100;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> level(-1.0, 1.0);
  TimeRecord r;
  r.file = "shaken.csv";
  r.step_s = kLooseStep;
  Mode loose{kLooseHz, 0.02};
  Mode own{11.4, 0.0121};
  double u = 0.0;
  double small = 0.0;
  double large = 0.0;
  double y = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double next = i % kTread == 20 ? level(random) : u;
    for (int k = 0; k < kFiner && i > 0; ++k) {
      const double now = u + (next - u) * (k + 0.5) / kFiner;
      small = std::clamp(small, now - 0.1, now + 0.1);
      large = std::clamp(large, now - 0.4, now + 0.4);
      const double h = kLooseStep / kFiner;
      y = own.step(loose.step(15.9 * (now + 0.06 * small + 0.1 * large), h), h);
    }
    u = next;
    r.u.push_back(u);
    r.y.push_back(y + 0.1 * normal(random));
  }
  return r;
}

TEST(SharedValues, FindTheSharpModeBehindTheLoops) {
  const auto base = stage_with_loops();
  const auto d = gap::diagnose(base, gap::Study::of({shaken(1)}, {shaken(2)}, base), {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "resonance");
  EXPECT_EQ(d.steps[0].placed, "after block 3");
  EXPECT_LT(d.final.train_rms, 0.11);
}

}  // namespace
