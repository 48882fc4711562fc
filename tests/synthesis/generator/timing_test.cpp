// Figures of the slope detector and of late switching, against what its parts say by hand.
#include "synthesis/generator/timing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "lti/frequency_grid.hpp"
#include "synthesis/generator/made_layout.hpp"

namespace bodesmith::generator {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

DisturbanceCircuit two_branches() {
  return layout_of({{"up", {0.3546, -0.6433, 0.2887}, {}}, {"down", {-0.2398, 0.0838, 0.156}, {}}});
}

TEST(SlopeDetector, ItsFiguresAreThoseOfItsParts) {
  const DisturbanceCircuit layout = two_branches();
  const SlopeDetectorFigures figures = make_timing(layout, {}).detector;
  const auto value = [&](const char* name) { return layout.part_named(name)->realised; };
  const schematic::Netlist netlist = layout.detector_netlist();
  // Both diodes at rest are a resistor of vt/2 Is beside Rd.
  const double vt = netlist.diode.emission * 1.380649e-23 * 300.15 / 1.602176634e-19;
  const double rest_ohm = 1.0 / (1.0 / value("Rd") + 2.0 * netlist.diode.saturation_a / vt);
  EXPECT_NEAR(figures.hum_50_hz_v * kTurn * 50.0 * value("Cd") * rest_ohm, figures.threshold_v,
              2e-3 * figures.threshold_v);
  const double limit_a = figures.threshold_v / value("Rd") +
                         netlist.diode.saturation_a * 2.0 * std::sinh(figures.threshold_v / vt);
  EXPECT_NEAR(figures.least_slope_v_per_s * value("Cd"), limit_a, 1e-3 * limit_a);
  EXPECT_DOUBLE_EQ(figures.noise_margin * figures.noise_v, 2.0 * figures.threshold_v);
  // No frequency needs less than the one that needs least.
  const SlopeDetector detector(netlist, "x");
  for (const double gain : detector.gains(log_grid({Hertz{1.0}, Hertz{10e6}}, 200)))
    EXPECT_LT(gain * figures.ripple_v, 1.002 * figures.threshold_v);
  EXPECT_NEAR(detector.gains({Hertz{figures.ripple_hz}})[0] * figures.ripple_v, figures.threshold_v,
              1e-9 * figures.threshold_v);
}

TEST(SlopeDetector, DelaysAreFromTheReversalOfATriangleAndASine) {
  const DisturbanceCircuit layout = two_branches();
  const Timing timing = make_timing(layout, {Hertz{200.0}, Hertz{2000.0}});
  const SlopeDetector detector(layout.detector_netlist(), "x");
  ASSERT_EQ(timing.detector.delays.size(), 2U);
  ASSERT_EQ(timing.analog_switch.late.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& delay = timing.detector.delays[i];
    const double f = delay.frequency.value;
    const auto at =
        detector.delay_s([f](double t) { return std::abs(1.0 - 2.0 * f * t); }, 0.0, 0.5 / f, 1.0 / f);
    ASSERT_TRUE(at && delay.triangle_s && delay.sine_s);
    EXPECT_NEAR(*delay.triangle_s, *at, 1e-3 * *at);
    const auto sine = detector.delay_s([f](double t) { return std::pow(std::cos(0.5 * kTurn * f * t), 2); },
                                       0.0, 0.5 / f, 1.0 / f);
    EXPECT_NEAR(*delay.sine_s, *sine, 1e-3 * *sine);
    EXPECT_GT(*delay.sine_s, *delay.triangle_s) << "its slope grows from nothing";
  }
  // A slope below the least one never arrives.
  const double slow = 0.2 * detector.least_slope_v_per_s();
  EXPECT_FALSE(make_timing(layout, {Hertz{0.5 * slow}}).detector.delays[0].triangle_s);
  EXPECT_TRUE(make_timing(layout, {Hertz{0.5 * slow}}).analog_switch.late.empty());
}

// The solver's step is not held at that of its first order, whatever the reference's period.
TEST(SlopeDetector, FollowsTheSlowestReferenceThatItIsMadeFor) {
  double faster = 0.0;
  for (const double lowest : {1.0, 0.5, 0.2, 0.15, 0.05, 0.01}) {
    Options options;
    options.lowest = Hertz{lowest};
    const auto layout =
        layout_of({{"up", {0.3546, -0.6433, 0.2887}, {}}, {"down", {-0.2398, 0.0838, 0.156}, {}}}, options);
    const auto delay = make_timing(layout, {options.lowest}).detector.delays.at(0);
    ASSERT_TRUE(delay.triangle_s && delay.sine_s) << lowest;
    EXPECT_GT(*delay.triangle_s, faster) << lowest;
    EXPECT_GT(*delay.sine_s, *delay.triangle_s) << lowest;
    EXPECT_LT(*delay.triangle_s, 1e-4 / lowest);
    faster = *delay.triangle_s;
  }
}

// A contact that closes half a period late or later shows no branch: refused, in words.
TEST(SwitchFigures, ADelayBeyondHalfAPeriodIsRefused) {
  DisturbanceCircuit layout = two_branches();
  layout.analog_switch.on_delay_s = 0.9e-3;
  EXPECT_NO_THROW(make_timing(layout, {Hertz{500.0}}));
  EXPECT_THROW(make_timing(layout, {Hertz{100.0}, Hertz{600.0}}), DesignError);
}

// At frequencies where nothing else is late, the error is the wrong branch for as long as it stays on: of the period 2 f times
// the delay, at either end, where the branches are |d_up - d_down| apart.
TEST(SwitchFigures, TheErrorIsTheWrongBranchForTheDelay) {
  const DisturbanceCircuit layout = two_branches();
  const SwitchFigures::Late late = make_timing(layout, {Hertz{500.0}}).analog_switch.late.at(0);
  const auto apart = [&](double x) { return 100.0 * (layout.realised(0, x) - layout.realised(1, x)); };
  constexpr int kParts = 1000;
  const double moved = 2.0 * 500.0 * late.delay_s;
  double square = 0.0;
  for (int i = 0; i < kParts; ++i) {
    const double x = moved * (i + 0.5) / kParts;
    square += 0.5 * moved * (std::pow(apart(x), 2) + std::pow(apart(1.0 - x), 2)) / kParts;
  }
  // The parts' own errors, and the multipliers' lag, which the quiet figure at 1 Hz and the time constant tell.
  const double own = make_timing(layout, {Hertz{20.0}}).analog_switch.late.at(0).rms_percent;
  EXPECT_GT(late.rms_percent, 0.7 * std::sqrt(square));
  EXPECT_LT(late.rms_percent, 1.3 * std::sqrt(square) + 2.0 * own);
  EXPECT_GE(late.peak_percent, 0.7 * late.step_percent);
  EXPECT_LT(late.peak_percent, 1.5 * late.step_percent + 0.2);
  EXPECT_GT(late.rms_off_percent, late.rms_percent);
}

// The open node decays through Rin from the held voltage and the charge; the amplifier follows with its closed-loop bandwidth, its
// output no faster than it slews. In small steps.
TEST(SwitchGlitch, IsTheAmplifierFollowingTheOpenNode) {
  DisturbanceCircuit layout = two_branches();
  const double feedback = layout.part(layout.passes.back().output.feedback).realised;
  const double input = layout.part(layout.passes.back().output.disturbance).realised;
  for (const double gap_s : {25e-9, 400e-9}) {
    for (const auto& [held, charge] : {std::pair(0.8, 0.0), std::pair(0.0, 1.0), std::pair(0.8, -1.0)}) {
      layout.analog_switch.gap_s = gap_s;
      const double farad = 2.0 * layout.analog_switch.drain_f, gain = feedback / input;
      const double w = kTurn * layout.opamp.gain_bandwidth.value / (1.0 + gain);
      double node = held + charge * layout.analog_switch.charge_c / farad, moved = 0.0, most = 0.0;
      constexpr int kSteps = 40000;
      const double h = gap_s / kSteps;
      for (int i = 1; i <= kSteps; ++i) {
        moved += h * w * (node - held - moved);
        node -= h * node / (input * farad);
        most = std::max(most, std::min(gain * std::abs(moved), layout.opamp.slew_v_per_s * i * h));
      }
      EXPECT_NEAR(switch_glitch_v(layout, held, charge), most, 0.01 * most)
          << gap_s << " " << held << " " << charge;
    }
  }
}

TEST(Layout, RefusesScalesThatAreNone) {
  for (const double volts : std::vector<double>{0.0, -1.0, NAN, INFINITY, 1e150}) {
    Options options;
    options.multiplier.scale_v = volts;
    EXPECT_THROW(layout_of({{"only", {0.1, -0.1}, {}}}, options), DesignError) << volts;
    options = Options();
    options.full_scale_v = volts;
    EXPECT_THROW(layout_of({{"only", {0.1, -0.1}, {}}}, options), DesignError) << volts;
  }
}

}  // namespace
}  // namespace bodesmith::generator
