// What a coarse grid misses: features beside clocks, zeros on the axis, op-amps inside a CAM.
#include "fpaa/plan/clock_features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/error_reference.hpp"
#include "fpaa/plan/plan_limits.hpp"
#include "fpaa/plan/switched_board.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// A low pass of 4.7 Hz sampled at 3 kHz, taken from a constant at 1 MHz: at 3 kHz the sampled path lets its slow
/// pole through again, and the hold makes a dip of it.
Plan sampled_path() {
  Plan plan;
  plan.board = "an231k04-quad4";
  PlacedCam low;
  low.name = "Low";
  low.cam = cam_registry().find("FilterBilinear");
  low.option = "Low Pass";
  low.clock_a = {16e6 / 5334};
  low.capacitors = {{"Cin", 2}, {"Cint", 202}, {"Cout", 2}};
  low.z = {{{-2.0}}, {204.0, -202.0}};
  PlacedCam sum;
  sum.name = "Sum";
  sum.cam = cam_registry().find("SumInv");
  sum.option = "2 inputs";
  sum.clock_a = {1e6};
  sum.capacitors = {{"Cin1", 2}, {"aCin1", 2}, {"Cin2", 200}, {"aCin2", 200}, {"Cout", 200}, {"aCout", 200}};
  sum.z = {{{-0.01}, {-1.0}}, {1.0}};
  ChipPlan chip{1, {16e6}, {}, {low, sum}};
  plan.chips = {chip};
  plan.wires = {{"chip1.in1", "chip1.Low"},
                {"chip1.in1", "chip1.Sum", 1},
                {"chip1.Low", "chip1.Sum", 2},
                {"chip1.Sum", "chip1.out1"}};
  return plan;
}

TEST(ClockFeatures, FindTheDipBesideAClock) {
  const Plan plan = sampled_path();
  const SwitchedBoard response(plan);
  const Band band{{2900.0}, {3100.0}};
  const Complex level = response.gain(Hertz{2900.0}.rad_s());
  const auto departs = [&](Hertz f) { return std::abs(response.gain(f.rad_s()) - level); };
  double dense = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    // Closest where the dip is: steps of 0.01 Hz a few hertz about the clock.
    const double x = 0.002 * i - 1.0;
    const Hertz f{3000.0 + 4.0 * x + 96.0 * x * x * x};
    if (std::abs(f.value - 16e6 / 5334) > 0.02) dense = std::max(dense, departs(f));
  }
  constexpr double kBeside[] = {-3.0, -1.0, -0.3, -0.1, 0.1, 0.3, 1.0, 3.0};
  double found = 0.0;
  for (const Hertz f : near_clocks(clocked_poles(plan), band, kBeside, 4))
    found = std::max(found, departs(f));
  double coarse = 0.0;
  for (const Hertz f : log_grid(band, 6)) coarse = std::max(coarse, departs(f));
  EXPECT_GT(found, 0.9 * dense);
  EXPECT_LT(coarse, 0.5 * dense);
}

TEST(ClockFeatures, BeatIsTheLargestImage) {
  // 1 % of the input as a constant, all of it through a slow path: beside the clock the beat is larger than the
  // signal.
  const Plan plan = sampled_path();
  const ImageLines images = images_of(SwitchedBoard(plan), plan, {{1.0}, {5000.0}});
  ASSERT_TRUE(images.largest && images.in_band);
  EXPECT_GT(images.largest->magnitude_db, 20.0);
  EXPECT_NEAR(images.largest->signal.value, 16e6 / 5334, 10.0);
  EXPECT_LT(images.largest->line.value, 10.0);
}

TEST(ErrorReference, ZerosOnTheAxisAreDamped) {
  const double w = 300.0;
  Sections notch;
  notch.sections = {{1.0, {{0.0, w}, {0.0, -w}}, {{-w, 0.0}, {-w, 0.0}}}};
  // (jw - z)(jw - z*) = 2 w 0.02 w at the zero, over 2 w^2.
  EXPECT_NEAR(error_reference(notch, {w}), 0.02, 1e-12);
  EXPECT_TRUE(beside_a_zero(notch, {1.01 * w}));
  EXPECT_FALSE(beside_a_zero(notch, {1.1 * w}));
  EXPECT_NEAR(error_reference(notch, {1.1 * w}), std::abs(notch.response(RadPerSecond{1.1 * w})), 1e-12);
}

TEST(ErrorReference, SharpRootsAreLookedAtSomeWidthsAround) {
  for (const double unit : {1.0, 1e3}) {
    const double w = 2.0 * M_PI * 100.0 * unit;
    const auto pair = [&](double damping) {
      const std::complex<double> root =
          w * std::complex<double>(-damping, std::sqrt(1.0 - damping * damping));
      Sections out;
      out.sections = {{1.0, {}, {root, std::conj(root)}}};
      return out;
    };
    const Band band{{10.0 * unit}, {1000.0 * unit}};
    const std::vector<Hertz> at = about_sharp_roots(pair(0.05), band);
    ASSERT_EQ(at.size(), 7U);
    const double middle = 100.0 * unit * std::sqrt(1.0 - 0.05 * 0.05);
    EXPECT_NEAR(at[3].value, middle, 1e-9 * middle);
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_NEAR(at[i].value + at[6 - i].value, 2.0 * middle, 1e-9 * middle);
    EXPECT_NEAR(at[6].value - at[0].value, 6.0 * 0.05 * 100.0 * unit, 1e-9 * middle);
    EXPECT_TRUE(about_sharp_roots(pair(0.3), band).empty());
    EXPECT_EQ(about_sharp_roots(pair(0.05), {{10.0 * unit}, {100.0 * unit}}).size(), 4U);
    // The sharpest as if they were damped by a fiftieth.
    const std::vector<Hertz> sharp = about_sharp_roots(pair(1e-6), band);
    EXPECT_NEAR(sharp[6].value - sharp[0].value, 6.0 * 0.02 * 100.0 * unit, 1e-6 * middle);
  }
}

TEST(ErrorReference, FarCornersDoNotWidenTheBand) {
  Sections s;
  s.sections = {{1.0, {-0.1}, {-2.0 * M_PI * 21.0}}, {1.0, {-1e8}, {-2.0 * M_PI * 1000.0}}};
  EXPECT_NEAR(judged_band(s).from.value, 0.1 / (2.0 * M_PI), 1e-9);
  s.error = Sections::Error{{{20.0}, {20000.0}}};
  EXPECT_NEAR(judged_band(s).from.value, 20.0, 1e-9);
  EXPECT_NEAR(judged_band(s).to.value, 20000.0, 1e-6);
}

}  // namespace
}  // namespace bodesmith::fpaa
