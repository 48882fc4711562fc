// CAMs in the time domain: networks against their own steady state for a sine, converters against their equations.
#include "fpaa/plan/board_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/multiplier.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/network/periodic_network.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;
using RunPart = BoardRun::Part;

constexpr double kRunClock = 250e3;
constexpr std::int64_t kRunPeriod = 128;  ///< ticks of 1/32 us

PlacedCam run_cam(const std::string& name, const Cam& cam, double delay_cycles = 0.0, int phase = 1) {
  PlacedCam out;
  out.name = name;
  out.cam = &cam;
  out.clock_a = {kRunClock};
  out.phase = phase;
  out.delay_cycles = delay_cycles;
  return out;
}

PlacedCam run_filter(const std::string& name, const char* option, std::vector<Capacitor> capacitors) {
  PlacedCam out = run_cam(name, *cam_registry().find("FilterBilinear"));
  out.option = option;
  out.capacitors = std::move(capacitors);
  return out;
}

/// Weights over 100 units; those above 0 are taken up in phase 2.
WiredCam run_sum(const std::string& name, const std::vector<std::string>& inputs,
                 const std::vector<double>& weights) {
  WiredCam out{run_cam(name, sum_diff_cam()), 1, inputs};
  out.z.numerators.resize(weights.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    out.realised.set("gain_" + number, weights[i]);
    out.capacitors.push_back({"Cin" + number, static_cast<int>(std::lround(std::abs(weights[i]) * 100.0))});
  }
  out.capacitors.push_back({"Cout", 100});
  return out;
}

RunPart run_ramp() {
  return {"r", {}, [](double t, std::span<const double>) { return 1000.0 * t; }};
}

TEST(BoardRun, AChainSettlesToItsPeriodicSteadyState) {
  const std::vector<PlacedCam> cams = {
      run_filter("A", "Pole and Zero", {{"Ca", 30}, {"Cb", 90}, {"Cc", 40}, {"Cd", 70}}),
      run_filter("B", "Low Pass", {{"Cin", 20}, {"Cint", 60}, {"Cout", 25}}),
      run_filter("C", "Pole and Zero", {{"Ca", 50}, {"Cb", 60}, {"Cc", 45}, {"Cd", 80}})};
  constexpr double kHz = 6250.0;  // 40 periods a turn
  const double w = 2.0 * std::numbers::pi * kHz;
  std::vector<WiredCam> cells;
  PeriodicNetworks networks(32e6);
  std::string before = "r";
  for (const PlacedCam& cam : cams) {
    using Source = PeriodicNetworks::Source;
    const auto stage = cam.cam->switches(cam);
    const Source from = networks.size() == 0 ? Source{Source::Kind::board_input, 0}
                                             : Source{Source::Kind::network, networks.size() - 1};
    networks.set_output(networks.add(ClockedNetwork(circuit_of(*stage), {kRunPeriod}), {from}));
    cells.push_back({cam, 1, {before}});
    before = cam.name;
  }
  BoardRun board(cells, {{"r", {}, [&](double t, std::span<const double>) { return std::cos(w * t); }}},
                 an231k04_quad4());
  std::complex<double> got = 0.0;
  // Every tick of one turn, after 60 turns: the component by the middle of each tick.
  const std::int64_t turn = 40 * kRunPeriod;
  for (std::int64_t tick = 60 * turn; tick < 61 * turn; ++tick) {
    const double t = static_cast<double>(tick) / 32e6;
    board.advance_to(t);
    got += 2.0 * board.value("C") * std::polar(1.0 / static_cast<double>(turn), -w * t);
  }
  const std::complex<double> wanted = networks.gain({w});
  EXPECT_LT(std::abs(got - wanted), 2e-3 * std::abs(wanted));
  EXPECT_THAT(board.clipped(), ::testing::IsEmpty());
}

TEST(BoardRun, HoldsOfOppositePhasesAreHalfACycleEach) {
  BoardRun board({{run_cam("A", hold_cam(), 0.5, 1), 1, {"r"}}, {run_cam("B", hold_cam(), 0.5, 2), 1, {"A"}}},
                 {run_ramp()}, an231k04_quad4());
  const double cycle = 1.0 / kRunClock;
  for (int n = 2; n < 20; ++n) {
    // A samples at the end of phase 1, (n + 1/2) cycle, and shows it from then on; B half a cycle later.
    board.advance_to((n + 0.75) * cycle);
    EXPECT_NEAR(board.value("A"), 1000.0 * (n + 0.5) * cycle, 1e-9);
    EXPECT_NEAR(board.value("B"), 1000.0 * (n - 0.5) * cycle, 1e-9);
    board.advance_to((n + 1.25) * cycle);
    EXPECT_NEAR(board.value("A"), 1000.0 * (n + 0.5) * cycle, 1e-9);
    EXPECT_NEAR(board.value("B"), 1000.0 * (n + 0.5) * cycle, 1e-9);
  }
}

TEST(BoardRun, ALoopIsItsRecursion) {
  // In phase 1 the sum shows r of the end of the phase 2 before, less .4 of what the Hold has of its last phase 1.
  BoardRun board({run_sum("S", {"r", "H"}, {1.0, -0.4}), {run_cam("H", hold_cam(), 0.5), 1, {"S"}}},
                 {run_ramp()}, an231k04_quad4());
  const double cycle = 1.0 / kRunClock;
  double v = 0.0;
  for (int n = 1; n < 50; ++n) {
    v = 1000.0 * n * cycle - 0.4 * v;
    board.advance_to((n + 0.25) * cycle);
    EXPECT_NEAR(board.value("S"), v, 1e-9) << n;
    board.advance_to((n + 0.75) * cycle);
    EXPECT_NEAR(board.value("S"), 0.0, 1e-12) << "it returns to ground";
    EXPECT_NEAR(board.value("H"), v, 1e-9);
  }
}

TEST(BoardRun, ALoopWithoutDelayIsRefused) {
  try {
    BoardRun board({run_sum("S", {"r", "T"}, {-1.0, -0.4}), run_sum("T", {"S", "r"}, {-0.5, -0.1})},
                   {run_ramp()}, an231k04_quad4());
    FAIL() << "expected a refusal";
  } catch (const DesignError& e) {
    EXPECT_THAT(e.what(), HasSubstr("loop without any delay"));
  }
}

TEST(BoardRun, ConvertersAndTables) {
  LookupTable table = value_or_throw(LookupTable::of([](double x) { return 0.5 * x * x - 2.0; }));
  WiredCam lookup{run_cam("T", transfer_function_cam(), 1.0), 1, {"r"}};
  lookup.requested = table.values();
  WiredCam product{run_cam("M", multiplier_cam(), 1.0), 1, {"r", "one"}};
  product.requested = Multiplier{.scale_per_v = 1.0 / 3.0}.values();
  const RunPart one{"one", {}, [](double, std::span<const double>) { return 1.0; }};
  BoardRun board({lookup, product}, {run_ramp(), one}, an231k04_quad4());
  const double cycle = 1.0 / kRunClock;
  for (int n = 2; n < 700; n += 7) {
    // Read at the end of phase 1, there a cycle later.
    board.advance_to((n + 0.5) * cycle);
    const double before = 1000.0 * (n - 0.5) * cycle;
    EXPECT_EQ(board.value("T"), table.output(before));
    EXPECT_NEAR(board.value("M"), before * Multiplier::quantised(1.0) / 3.0, 1e-12);
  }
}

TEST(BoardRun, ClipsAtFullScale) {
  BoardRun board({{run_filter("G", "Low Pass", {{"Cin", 200}, {"Cint", 1}, {"Cout", 10}}), 1, {"r"}}},
                 {run_ramp()}, an231k04_quad4());
  board.advance_to(0.1e-3);
  EXPECT_THAT(board.clipped(), ::testing::IsEmpty());
  board.advance_to(1e-3);
  EXPECT_EQ(board.value("G"), -3.0);
  EXPECT_THAT(board.clipped(), ::testing::ElementsAre("G"));
}

}  // namespace
}  // namespace bodesmith::fpaa
