#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/opamp_library.hpp"
#include "seed_sections.hpp"
#include "synthesis/opamp_check.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {
namespace {

using schematic::OpAmpLibrary;

/// -R2/R1 around one op-amp.
Circuit inverting(double r1, double r2) {
  Circuit out;
  Part a, b;
  a.name = "R1";
  a.from = "in";
  a.to = "m";
  a.realised = r1;
  b.name = "R2";
  b.from = "m";
  b.to = "out";
  b.realised = r2;
  out.parts = {a, b};
  out.opamps = {{"U1", "", 0, "0", "m", "out"}};
  return out;
}

// Textbook: en (1 + R2/R1), sqrt(4kT R2), sqrt(4kT R1) R2/R1, in R2.
TEST(Noise, InvertingAmplifierByHand) {
  Circuit circuit = inverting(10e3, 100e3);
  OpAmpModel& model = circuit.opamp;
  model.gain_bandwidth = Hertz{1e12};
  model.dc_gain = 1e9;
  model.output_resistance_ohm = 0.0;
  model.voltage_noise_v_per_rthz = 8e-9;
  model.current_noise_a_per_rthz = 1e-12;
  const double kt4 = 4.0 * 1.380649e-23 * 300.15;
  const double expected =
      std::sqrt(std::pow(8e-9 * 11.0, 2) + kt4 * 100e3 + kt4 * 10e3 * 100.0 + std::pow(1e-12 * 100e3, 2));
  EXPECT_NEAR(schematic::output_noise(circuit, {Hertz{1000}}, false)[0] / expected, 1.0, 1e-6);
  EXPECT_NEAR(
      schematic::output_noise_rms(circuit, {Hertz{100}, Hertz{1100}}, false) / (expected * std::sqrt(1000.0)),
      1.0, 1e-3);
  EXPECT_NEAR(schematic::worst_output_offset(circuit), model.offset_v * 11.0 + model.bias_current_a * 100e3,
              1e-9);
}

// The output feeds R2, whose other end is at virtual ground, and nothing else.
TEST(OpAmpCheck, StatesTheCurrentOfTheHardestWorkingOutput) {
  Circuit circuit = inverting(1e3, 50.0);
  const Band band{Hertz{10}, Hertz{1000}};
  const OpAmpCheck check = check_opamps(circuit, band, 10.0);
  EXPECT_NEAR(check.output_current_a, 10e-3, 1e-6);
  const auto tells = [](const OpAmpCheck& of) {
    return std::any_of(of.warnings.begin(), of.warnings.end(), [](const std::string& one) {
      return one.find("delivers 10 mA") != std::string::npos;
    });
  };
  EXPECT_FALSE(tells(check));
  circuit.opamp.greatest_output_current_a = 9e-3;
  EXPECT_TRUE(tells(check_opamps(circuit, band, 10.0)));
}

/// -100k/10k of one op-amp, described as a stage, with a capacitor of this many farad at its output.
Circuit loaded(double farad) {
  Circuit out = inverting(10e3, 100e3);
  if (farad > 0.0) {
    Part c;
    c.name = "C1";
    c.kind = Part::Kind::capacitor;
    c.from = "out";
    c.to = "0";
    c.realised = farad;
    out.parts.push_back(c);
  }
  return out;
}

// L = A(s) beta: behind Ro with the load and the feedback's resistors on it, beta = R1/(R1 + R2).
TEST(OpAmpCheck, PhaseMarginIsThatOfTheLoopByHand) {
  for (const double farad : {0.0, 1e-9, 100e-9}) {
    const Circuit circuit = loaded(farad);
    const OpAmpModel& model = circuit.opamp;
    const auto loop = [&](double f) {
      const Complex load = 1.0 / 110e3 + Complex(0.0, 2.0 * std::numbers::pi * f * farad);
      return model.open_loop(Hertz{f}.rad_s()) / 11.0 / (1.0 + model.output_resistance_ohm * load);
    };
    double low = 1e3, high = 1e8;
    for (int i = 0; i < 60; ++i)
      (std::abs(loop(std::sqrt(low * high))) > 1.0 ? low : high) = std::sqrt(low * high);
    const double margin = 180.0 + std::arg(loop(low)) * 180.0 / std::numbers::pi;
    const OpAmpCheck check = check_opamps(circuit, {Hertz{10}, Hertz{1000}});
    EXPECT_NEAR(check.min_phase_margin_deg, std::min(margin, 90.0), 0.2) << farad;
    EXPECT_EQ(check.tightest_stage, farad > 0.0 ? 1U : 0U);
  }
}

// Of stages of Q = 4 at 10 kHz and Q = 10 at 1 kHz the first asks more: 100 Q f; of real poles none.
TEST(OpAmpCheck, TheHardestResonanceIsThatOfTheLargestQTimesFrequency) {
  const auto stage = [](double q, double hz) {
    const double w = 2.0 * std::numbers::pi * hz;
    Stage out;
    out.realised = {{.b0 = w * w, .a0 = w * w, .a1 = w / q, .a2 = 1.0}};
    return out;
  };
  Circuit circuit = loaded(0.0);
  circuit.stages = {stage(10.0, 1e3), stage(4.0, 10e3), stage(0.5, 1e6)};
  circuit.opamp.gain_bandwidth = Hertz{3.9e6};
  OpAmpCheck check = check_opamps(circuit, {Hertz{10}, Hertz{100}});
  EXPECT_NEAR(check.highest_q, 10.0, 1e-9);
  const auto said = [&] { return check.warnings.empty() ? std::string() : check.warnings.back(); };
  EXPECT_NE(said().find("Q = 4 at 10 kHz requires a gain-bandwidth of 4 MHz or more"), std::string::npos)
      << said();
  circuit.opamp.gain_bandwidth = Hertz{4.1e6};
  check = check_opamps(circuit, {Hertz{10}, Hertz{100}});
  EXPECT_EQ(said().find("requires a gain-bandwidth"), std::string::npos) << said();
}

TEST(OpAmpCheck, EachFigureWarnsFromItsLimitOn) {
  const Realised made = realise(seed_sections());
  const Band band = made.report.band;
  const OpAmpCheck good = check_opamps(made.circuit, band);
  ASSERT_TRUE(good.warnings.empty());
  const auto warnings = [&](const std::function<void(OpAmpModel&)>& change, double amplitude_v = 1.0) {
    Circuit circuit = made.circuit;
    change(circuit.opamp);
    return check_opamps(circuit, band, amplitude_v).warnings;
  };
  const auto only = [](const std::vector<std::string>& all, const std::string& words) {
    return all.size() == 1 && all[0].find(words) != std::string::npos;
  };
  const double full = good.full_swing_hz;
  const auto slew_for = [&](double times) {
    return warnings([&](OpAmpModel& m) { m.slew_v_per_s *= times * band.to.value / full; });
  };
  EXPECT_TRUE(slew_for(1.01).empty());
  EXPECT_TRUE(only(slew_for(0.99), "slews above"));
  // The slew rate is that of a sine at the highest node: twice the amplitude, half the frequency.
  EXPECT_NEAR(check_opamps(made.circuit, band, 2.0).full_swing_hz, 0.5 * full, 1e-9 * full);
  const double highest = made.circuit.opamp.slew_v_per_s / (2.0 * std::numbers::pi * full);
  EXPECT_TRUE(warnings([&](OpAmpModel& m) { m.swing_v = 1.01 * highest; }).empty());
  EXPECT_TRUE(only(warnings([&](OpAmpModel& m) { m.swing_v = 0.99 * highest; }), "a stage reaches"));
  const double current = good.output_current_a;
  EXPECT_TRUE(warnings([&](OpAmpModel& m) { m.greatest_output_current_a = 1.01 * current; }).empty());
  EXPECT_TRUE(
      only(warnings([&](OpAmpModel& m) { m.greatest_output_current_a = 0.99 * current; }), "delivers"));
  EXPECT_NEAR(check_opamps(made.circuit, band, 3.0).output_current_a, 3.0 * current, 1e-9 * current);
  const auto offset_for = [&](double part) {
    return warnings([&](OpAmpModel& m) {
      m.offset_v *= part * 0.01 / good.output_offset_v;
      m.bias_current_a *= part * 0.01 / good.output_offset_v;
    });
  };
  EXPECT_TRUE(offset_for(0.99).empty());
  EXPECT_TRUE(only(offset_for(1.01), "add up to"));
  // The circuit is linear: with limits as many times as large as the amplitude the same is warned of.
  for (const double amplitude : {0.2, 1.0, 3.0}) {
    for (const double part : {0.99, 1.01}) {
      const auto scaled = [&](OpAmpModel& m) {
        m.slew_v_per_s *= part * amplitude * band.to.value / full;
        m.swing_v = part * amplitude * highest;
        m.greatest_output_current_a = part * amplitude * current;
        m.offset_v *= amplitude / part * 0.01 / good.output_offset_v;
        m.bias_current_a *= amplitude / part * 0.01 / good.output_offset_v;
      };
      EXPECT_EQ(warnings(scaled, amplitude).size(), part < 1.0 ? 4u : 0u) << amplitude;
    }
  }
  EXPECT_NEAR(good.noise_rms_v, schematic::output_noise_rms(made.circuit, band), 1e-12);
}

TEST(OpAmpCheck, TheHardestResonanceAsksForAHundredTimesItsFrequency) {
  Sections pairs;
  for (const auto& [hz, damping] : {std::pair(1000.0, 0.1), std::pair(3000.0, 0.25)}) {
    const double w = Hertz{hz}.rad_s().value;
    const Complex pole = w * Complex(-damping, std::sqrt(1.0 - damping * damping));
    Section one;
    one.gain = w * w;
    one.poles = {pole, std::conj(pole)};
    pairs.sections.push_back(one);
  }
  RealiseOptions options;
  options.opamp.gain_bandwidth = Hertz{100e6};
  const Realised made = realise(pairs, options);
  const OpAmpCheck check = check_opamps(made.circuit, made.report.band);
  // Q = 5 and 2: at 3 kHz times 2 more is asked than at 1 kHz times 5.
  EXPECT_NEAR(check.highest_q, 5.0, 0.1);
  const auto asks = [&](double hz) {
    Circuit circuit = made.circuit;
    circuit.opamp.gain_bandwidth = Hertz{hz};
    for (const std::string& one : check_opamps(circuit, made.report.band).warnings) {
      if (one.find("requires a gain-bandwidth") != std::string::npos) return one;
    }
    return std::string();
  };
  EXPECT_EQ(asks(0.62e6), "");
  EXPECT_NE(asks(0.58e6).find("Q = 2"), std::string::npos) << asks(0.58e6);
}

TEST(OpAmpCheck, WarnsWithNumbers) {
  Realised made = realise(seed_sections());
  const Band band = made.report.band;
  const OpAmpCheck fine = check_opamps(made.circuit, band);
  EXPECT_TRUE(fine.warnings.empty()) << fine.warnings[0];
  EXPECT_GT(fine.min_phase_margin_deg, 45.0);
  RealiseOptions bare;
  bare.isolation_ohm = 0.0;
  const Realised ringing = realise(seed_sections(), bare);
  ASSERT_FALSE(ringing.report.warnings.empty());
  EXPECT_NE(ringing.report.warnings[0].find("phase margin"), std::string::npos);
  const OpAmpLibrary library = OpAmpLibrary::built_in();
  made.circuit.opamp = library.named("NE5532");  // 200 nA through megohms
  const OpAmpCheck bipolar = check_opamps(made.circuit, band);
  EXPECT_GT(bipolar.output_offset_v, 0.1);
  ASSERT_FALSE(bipolar.warnings.empty());
  EXPECT_NE(bipolar.warnings[0].find("bias current"), std::string::npos) << bipolar.warnings[0];
  made.circuit.opamp.gain_bandwidth = Hertz{2e4};
  made.circuit.opamp.slew_v_per_s = 1e3;
  EXPECT_GE(check_opamps(made.circuit, band).warnings.size(), 3u);
}

}  // namespace
}  // namespace bodesmith::synthesis
