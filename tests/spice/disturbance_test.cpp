#include <gtest/gtest.h>

#include <cmath>

#include "circuit/layout.hpp"
#include "spice/emit.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith {
namespace {

Disturbance seed_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  return d;
}

TEST(DisturbanceLibrary, NgspiceMakesThePolynomialsOfBothBranches) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  const Disturbance wanted = seed_disturbance();
  const DisturbanceLayout layout = layout_disturbance(wanted);
  const std::string library = disturbance_library(layout, "seed");
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    const std::string deck = "static\n" + library + "Vx x 0 0\nVb branch 0 " +
                             (branch == Disturbance::Branch::ascending ? "1" : "0") +
                             "\nX1 x branch out disturbance\n";
    const DcSweep sweep = run_dc(deck, "Vx", 0.0, 1.0, 0.02, {"out"}, "disturbance.sub");
    ASSERT_GE(sweep.source_v.size(), 50u);
    for (size_t i = 0; i < sweep.source_v.size(); ++i) {
      const double x = sweep.source_v[i];
      EXPECT_NEAR(sweep.v[0][i], layout.value(branch, x), 3e-6) << "x = " << x;
      EXPECT_NEAR(sweep.v[0][i], wanted.value(branch, x), 4e-4) << "x = " << x;
    }
  }
}

TEST(DisturbanceLibrary, SlopeDetectorSwitchesTheBranchesOfATriangle) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  const Disturbance wanted = seed_disturbance();
  const std::string library = disturbance_library(layout_disturbance(wanted), "seed");
  for (const double f : {1.0, 100.0, 5000.0}) {
    const double t = 1.0 / f;
    std::string points = "0 0";
    for (int half = 1; half <= 4; ++half) {
      char text[64];
      std::snprintf(text, sizeof text, " %.12g %d", half * 0.5 * t, half % 2);
      points += text;
    }
    const std::string deck = "triangle\n" + library + "Vx x 0 PWL(" + points +
                             ")\nXs x branch slope_detector\nX1 x branch out disturbance\n";
    const Transient run = run_transient(deck, {"x", "branch", "out"}, t / 2000.0, 2.0 * t, "disturbance.sub");
    double late = 0.0, sum = 0.0, total = 0.0;
    for (size_t i = 1; i < run.time_s.size(); ++i) {
      const double now = run.time_s[i];
      if (now < t) continue;
      const bool rising = std::fmod(now, t) < 0.5 * t;
      const double dt = now - run.time_s[i - 1];
      if ((run.v[1][i] > 0.5) != rising) late += dt;
      const double x = run.v[0][i];
      const double d =
          wanted.value(rising ? Disturbance::Branch::ascending : Disturbance::Branch::descending, x);
      sum += dt * (run.v[2][i] - d) * (run.v[2][i] - d);
      total += dt;
    }
    // Late by a few per mille of a period up to 100 Hz, by 6 microseconds at 5 kHz.
    EXPECT_LT(late / t, f > 1000.0 ? 0.035 : 0.004) << f << " Hz";
    EXPECT_LT(100.0 * std::sqrt(sum / total), f > 1000.0 ? 0.2 : 0.02) << f << " Hz, percent of range";
  }
}

}  // namespace
}  // namespace bodesmith
