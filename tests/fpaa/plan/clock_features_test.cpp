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

TEST(ClockFeatures, FindTheDipNextToAClock) {
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

TEST(ClockFeatures, TheBeatOfASineNextToAClockClipsFirst) {
  // A lead of gain 1 at rest in front of a low pass of gain 3, which samples at 3 kHz: next to that and to 6 kHz the beat has the
  // lead's gain there.
  Plan plan = sampled_path();
  PlacedCam& low = plan.chips[0].cams[0];
  low.capacitors = {{"Cin", 6}, {"Cint", 202}, {"Cout", 2}};
  low.z = {{{-6.0}}, {204.0, -202.0}};
  PlacedCam lead;
  lead.name = "Lead";
  lead.cam = cam_registry().find("FilterBilinear");
  lead.option = "Pole and Zero";
  lead.clock_a = {16e6 / 889};
  lead.capacitors = {{"Ca", 50}, {"Cb", 100}, {"Cc", 50}, {"Cd", 20}};
  lead.z = {{{150.0, -50.0}}, {70.0, -20.0}};
  plan.chips[0].cams = {low, lead};
  plan.wires = {{"chip1.in1", "chip1.Lead"}, {"chip1.Lead", "chip1.Low"}, {"chip1.Low", "chip1.out1"}};
  const SwitchedBoard board(plan);
  double largest = 0.0;
  for (int k = 0; k <= 2; ++k) {
    for (int i = 1; i <= 100; ++i) {
      for (const auto& node : board.nodes(Hertz{k * low.clock_a.value + 0.1 * i}.rad_s())) {
        for (const PeriodicNetworks::NodeSize& size : node) largest = std::max(largest, size.largest);
      }
    }
  }
  const Headroom headroom = headroom_of(board, plan, {{1.0}, {1000.0}});
  EXPECT_NEAR(headroom.sine_v * largest / kFullScaleV, 1.0, 0.01);
  EXPECT_LT(headroom.sine_v, 0.3 * headroom.step_v);
  EXPECT_NEAR(headroom.step_v * 3.0 / kFullScaleV, 1.0, 0.1);
}

/// What a path of 7 Hz lets through of the lines of clocks: the power of all of them of a sine together, by the definition.
double let_through(double hz, std::span<const double> clocks, Band band) {
  std::vector<double> lines;
  double sum = 0.0;
  for (const double clock : clocks) {
    for (int k = -30; k <= 30; ++k) {
      const double line = k * clock + hz;
      const double size = std::abs(line);
      if (k == 0 || size < band.from.value || size > band.to.value) continue;
      if (std::ranges::any_of(lines, [&](double other) { return std::abs(other - line) < 1e-6; })) continue;
      lines.push_back(line);
      sum += 1.0 / (1.0 + std::pow(size / 7.0, 2));
    }
  }
  return sum;
}

TEST(ClockFeatures, ImagesAreTheMeanOverAllSinesOfTheBand) {
  for (const auto& [clocks, band] : {std::pair{std::vector{800.0, 1600.0, 20e3}, Band{{3.0}, {5000.0}}},
                                     std::pair{std::vector{300.0, 800.0}, Band{{0.5}, {5000.0}}},
                                     std::pair{std::vector{300.0}, Band{{40.0}, {250.0}}}}) {
    const double whole = std::log(band.to.value / band.from.value);
    constexpr int kDense = 60000;
    double wanted = 0.0, spread = 0.0;
    for (int i = 0; i < kDense; ++i)
      wanted += let_through(band.from.value * std::exp((i + 0.5) / kDense * whole), clocks, band) / kDense;
    for (const Hertz f : log_grid(band, 16)) spread += let_through(f.value, clocks, band) / 16;
    for (const auto& [most, within] : {std::pair{1e9, 0.02}, std::pair{150.0, 0.15}}) {
      double mean = 0.0;
      const std::vector<BandSine> sines = image_sines(clocks, band, most);
      EXPECT_LE(static_cast<double>(sines.size()), most);
      for (const BandSine& sine : sines) {
        for (const double line : clock_lines_hz(clocks, sine.clock, sine.frequency.value, band))
          mean += sine.share / (1.0 + std::pow(line / 7.0, 2));
      }
      EXPECT_NEAR(mean, wanted, within * wanted)
          << clocks[0] << " " << most << ", of sixteen alone " << spread;
    }
  }
  const double fast[] = {20e3};
  EXPECT_TRUE(image_sines(fast, {{3.0}, {5000.0}}, 1e9).empty());
}

}  // namespace
}  // namespace bodesmith::fpaa
