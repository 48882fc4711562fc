// CAMs run event by event, against difference equations written down here.
#include "fpaa/cam_simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/gain_hold.hpp"
#include "fpaa/cams/hold.hpp"
#include "fpaa/cams/multiplier.hpp"
#include "fpaa/cams/sum_diff.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;
using Cell = CamSimulation::Cell;
using Part = CamSimulation::Part;

constexpr double kClock = 250e3;

PlacedCam placed_alone(const std::string& name, const Cam& cam, double delay_cycles, int phase = 1) {
  PlacedCam out;
  out.name = name;
  out.cam = &cam;
  out.clock_a = {kClock};
  out.phase = phase;
  out.delay_cycles = delay_cycles;
  return out;
}

/// Weights over 100 units; those above 0 are late.
Cell sum(const std::string& name, const std::vector<std::string>& inputs,
         const std::vector<double>& weights) {
  Cell out{placed_alone(name, sum_diff_cam(), 0.0), inputs, {}};
  out.cam.z = {{100.0 * weights[0]}, {100.0}};
  for (std::size_t i = 1; i < weights.size(); ++i) out.cam.more_numerators.push_back({100.0 * weights[i]});
  for (const double w : weights) out.late.push_back(w > 0.0);
  return out;
}

Part ramp() {
  return {"r", {}, [](double t, std::span<const double>) { return 1000.0 * t; }};
}

TEST(CamSimulation, HoldsOfOppositePhasesAreHalfACycleEach) {
  CamSimulation board({{placed_alone("A", hold_cam(), 0.5, 1), {"r"}, {}},
                       {placed_alone("B", hold_cam(), 0.5, 2), {"A"}, {}}},
                      {ramp()}, an231k04_quad4());
  const double cycle = 1.0 / kClock;
  for (int n = 2; n < 20; ++n) {
    board.advance_to(n * cycle);
    EXPECT_NEAR(board.value("A"), 1000.0 * (n - 1) * cycle, 1e-12);
    EXPECT_NEAR(board.value("B"), 1000.0 * (n - 1) * cycle, 1e-12) << "appeared just now";
    board.advance_to((n + 0.6) * cycle);
    EXPECT_NEAR(board.value("A"), 1000.0 * n * cycle, 1e-12);
  }
}

TEST(CamSimulation, ALoopIsItsRecursion) {
  // v[n] = r(n - 1/2) - .4 v[n-1]: the sum's own input is late by half a cycle, the Hold by one for the sum.
  CamSimulation board({sum("S", {"r", "H"}, {1.0, -0.4}), {placed_alone("H", hold_cam(), 0.5), {"S"}, {}}},
                      {ramp()}, an231k04_quad4());
  const double cycle = 1.0 / kClock;
  double v = 0.0;
  for (int n = 0; n < 50; ++n) {
    const double r = n == 0 ? 0.0 : 1000.0 * (n - 0.5) * cycle;
    v = r - 0.4 * v;
    board.advance_to(n * cycle);
    EXPECT_NEAR(board.value("S"), v, 1e-12) << n;
  }
}

TEST(CamSimulation, ConvertersAndTables) {
  LookupTable table = value_or_throw(LookupTable::of([](double x) { return 0.5 * x * x - 2.0; }));
  Cell lookup{placed_alone("T", transfer_function_cam(), 1.0), {"r"}, {}};
  lookup.cam.requested = table.values();
  Cell product{placed_alone("M", multiplier_cam(), 1.0), {"r", "one"}, {}};
  product.cam.requested = Multiplier{.scale_per_v = 1.0 / 3.0}.values();
  const Part one{"one", {}, [](double, std::span<const double>) { return 1.0; }};
  CamSimulation board({lookup, product}, {ramp(), one}, an231k04_quad4());
  const double cycle = 1.0 / kClock;
  for (int n = 1; n < 700; n += 7) {
    board.advance_to(n * cycle);
    const double before = 1000.0 * (n - 1) * cycle;
    EXPECT_EQ(board.value("T"), table.output(before));
    EXPECT_NEAR(board.value("M"), before * Multiplier::quantised(1.0) / 3.0, 1e-12);
  }
  EXPECT_EQ(LookupTable::from(table.values()).bytes, table.bytes);
  board.advance_to(4e-3);
  EXPECT_THAT(board.clipped(), ::testing::IsEmpty());
}

TEST(CamSimulation, ClipsAtFullScale) {
  Cell gain{placed_alone("G", gain_hold_cam(), 0.0), {"r"}, {}};
  gain.cam.z = {{-200.0}, {10.0}};
  CamSimulation board({gain}, {ramp()}, an231k04_quad4());
  board.advance_to(0.1e-3);
  EXPECT_THAT(board.clipped(), ::testing::IsEmpty());
  board.advance_to(1e-3);
  EXPECT_EQ(board.value("G"), -3.0);
  EXPECT_THAT(board.clipped(), ::testing::ElementsAre("G"));
}

/// a0 y[n] = b0 x[n] + b1 x[n-1] - a1 y[n-1], stage after stage.
TEST(CamSimulation, AChainIsItsDifferenceEquations) {
  const Plan& plan = seed_plan();
  std::vector<Cell> cells;
  std::string before = "r";
  for (const PlacedCam* cam : plan.cams()) {
    cells.push_back({*cam, {before}, {}});
    before = cam->name;
  }
  const auto input = [](double t) { return std::sin(2.0 * 3.14159265358979 * 30.0 * t); };
  CamSimulation board(cells, {{"r", {}, [&](double t, std::span<const double>) { return input(t); }}},
                      an231k04_quad4());
  std::vector<double> last_x(cells.size(), 0.0);
  std::vector<double> last_y(cells.size(), 0.0);
  for (int n = 0; n < 500; ++n) {
    const double t = n / 2000.0;
    double signal = input(t);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto& above = cells[i].cam.z.numerator;
      const auto& below = cells[i].cam.z.denominator;
      const double b1 = above.size() > 1 ? above[1] : 0.0;
      const double a1 = below.size() > 1 ? below[1] : 0.0;
      const double y = (above[0] * signal + b1 * last_x[i] - a1 * last_y[i]) / below[0];
      last_x[i] = signal;
      last_y[i] = signal = y;
    }
    board.advance_to(t + 1e-8);
    ASSERT_NEAR(board.value(before), signal, 1e-9) << t;
  }
}

/// More than a period late: as many samples wait.
TEST(CamSimulation, SeveralSamplesAreOnTheirWayInALongDelay) {
  CamSimulation board({{placed_alone("H", hold_cam(), 2.5), {"r"}, {}}}, {ramp()}, an231k04_quad4());
  const double cycle = 1.0 / kClock;
  for (int n = 0; n < 20; ++n) {
    board.advance_to((n + 0.6) * cycle);
    EXPECT_NEAR(board.value("H"), n < 2 ? 0.0 : 1000.0 * (n - 2) * cycle, 1e-12);
  }
}

TEST(CamSimulation, SaysWhatIsWrong) {
  const auto message = [](const std::vector<Cell>& cells) -> std::string {
    try {
      const CamSimulation board(cells, {ramp()}, an231k04_quad4());
    } catch (const DesignError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message({sum("S", {"nothing"}, {1.0})}), HasSubstr("S reads 'nothing'"));
  EXPECT_THAT(message({sum("S", {"r", "T"}, {1.0, -1.0}), sum("T", {"S"}, {-1.0})}),
              HasSubstr("loop without any delay"));
  EXPECT_THAT(message({{placed_alone("H", hold_cam(), -0.5), {"r"}, {}}}), HasSubstr("late by -0.5 cycles"));
}

}  // namespace
}  // namespace bodesmith::fpaa
