// Analyses of netlists against closed forms and against differences of themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include "schematic/analysis/response.hpp"

namespace bodesmith::schematic {
namespace {

using Complex = std::complex<double>;

Part resistor(const char* name, const char* from, const char* to, double ohm) {
  return {Part::Kind::resistor, name, "", 0, from, to, "exact", ohm, ohm};
}
Part capacitor(const char* name, const char* from, const char* to, double farad) {
  return {Part::Kind::capacitor, name, "", 0, from, to, "exact", farad, farad};
}

/// Sallen and Key's low-pass of gain 2: an op-amp with feedback of both signs.
Netlist sallen_key() {
  Netlist out;
  out.parts = {resistor("R1", "in", "a", 12e3),     resistor("R2", "a", "p", 18e3),
               resistor("Ra", "m", "0", 10e3),      resistor("Rb", "m", "out", 10e3),
               capacitor("C1", "a", "out", 4.7e-9), capacitor("C2", "p", "0", 2.2e-9)};
  out.opamps = {{"U1", "", 0, "p", "m", "out"}};
  return out;
}

TEST(Equations, AnIdealOpAmpMakesTheTextbooksTransfer) {
  const Equations equations(sallen_key(), {.ideal_opamps = true});
  for (const double w : {1e2, 1e4, 3e4, 1e6}) {
    const Complex s(0.0, w);
    const double k = 2.0, r1 = 12e3, r2 = 18e3, c1 = 4.7e-9, c2 = 2.2e-9;
    const Complex wanted = k / (1.0 + s * (c2 * (r1 + r2) + (1.0 - k) * r1 * c1) + s * s * r1 * r2 * c1 * c2);
    EXPECT_LT(std::abs(equations.response({w}) / wanted - 1.0), 1e-12) << w;
  }
}

TEST(Equations, AFiniteOpAmpClosesItsLoopByItsOwnGain) {
  Netlist follower;
  follower.parts = {resistor("Rl", "out", "0", 1e3)};
  follower.opamps = {{"U1", "", 0, "in", "out", "out"}};
  follower.opamp.dc_gain = 1e4;
  follower.opamp.gain_bandwidth = Hertz{1e6};
  follower.opamp.output_resistance_ohm = 100.0;
  const Equations equations(follower);
  for (const double w : {1.0, 1e5, 1e7}) {
    // A/(1 + A) of what the output stage leaves: A (1 - h) = h (1 + Ro/Rl).
    const Complex a = follower.opamp.open_loop({w}), wanted = a / (a + 1.1);
    EXPECT_LT(std::abs(equations.response({w}) - wanted), 1e-12) << w;
    // Cut at its source, the way back is Rl/(Rl + Ro).
    EXPECT_LT(std::abs(return_ratios(equations, follower, {0}, {w})[0] / (a / 1.1) - 1.0), 1e-12) << w;
  }
}

TEST(Equations, AMultiplierIsItsDerivativesAboutThePoint) {
  Netlist n;
  n.multipliers = {{"M", "", 0, "in", "y", "z", "out", 0.0}};
  n.sources = {{"Vy", "", "y", 0.4}, {"Vz", "", "z", -0.1}};
  n.multiplier.scale_v = 1.05;
  n.multiplier.bandwidth = Hertz{1e6};
  Equations equations(n);
  equations.linearise({{"in", 0.7}, {"y", 0.4}, {"z", -0.1}});
  const double w = 2.0 * M_PI * 1e6;
  EXPECT_LT(std::abs(equations.response({w}) - 0.4 / 1.05 / Complex(1.0, 1.0)), 1e-12);
}

TEST(Sensitivity, TheAdjointIsTheDifferenceQuotient) {
  for (const bool ideal : {true, false}) {
    Netlist n = sallen_key();
    const Assumptions assumptions{.ideal_opamps = ideal};
    for (const double w : {1e3, 2e4, 2e5}) {
      const auto slopes = log_sensitivities(Equations(n, assumptions), n.parts.size(), {w});
      for (std::size_t i = 0; i < n.parts.size(); ++i) {
        constexpr double kStep = 1e-5;
        const double nominal = n.parts[i].realised;
        n.parts[i].realised = nominal * std::exp(kStep);
        const Complex up = Equations(n, assumptions).response({w});
        n.parts[i].realised = nominal * std::exp(-kStep);
        const Complex down = Equations(n, assumptions).response({w});
        n.parts[i].realised = nominal;
        EXPECT_LT(std::abs(slopes[i] - std::log(up / down) / (2.0 * kStep)), 1e-7)
            << n.parts[i].name << " at " << w;
      }
      // Impedance and frequency scaling: sum over R less sum over C of d ln H is 0 for ideal op-amps.
      if (!ideal) continue;
      Complex resistors = 0.0, capacitors = 0.0;
      for (std::size_t i = 0; i < n.parts.size(); ++i)
        (n.parts[i].kind == Part::Kind::resistor ? resistors : capacitors) += slopes[i];
      EXPECT_LT(std::abs(resistors - capacitors), 1e-10);
    }
  }
}

/// A diode has no value to be off by; it loads the circuit by its slope all the same.
TEST(Sensitivity, ADiodeHasNone) {
  Netlist n = sallen_key();
  n.parts.push_back({Part::Kind::diode, "D1", "", 0, "out", "0", "1N4148", 0.0, 0.0});
  const auto with = log_sensitivities(Equations(n), n.parts.size(), {2e4});
  EXPECT_EQ(with.back(), 0.0);
  constexpr double kStep = 1e-5;
  Netlist up = n, down = n;
  up.parts[0].realised *= std::exp(kStep);
  down.parts[0].realised *= std::exp(-kStep);
  const Complex slope =
      std::log(Equations(up).response({2e4}) / Equations(down).response({2e4})) / (2.0 * kStep);
  EXPECT_LT(std::abs(with[0] - slope), 1e-7);
}

TEST(ResponseOfParts, IsThatOfTheNetlistWithTheseParts) {
  Netlist netlist = sallen_key();
  const std::vector<Hertz> grid{Hertz{0.0}, Hertz{50.0}, Hertz{3e3}, Hertz{1e6}};
  for (const bool ideal : {true, false}) {
    ResponseOfParts of_parts(sallen_key(), grid, {.ideal_opamps = ideal});
    for (const double factor : {0.5, 1.0, 1.03, 20.0}) {
      std::vector<double> values;
      for (std::size_t i = 0; i < netlist.parts.size(); ++i) {
        netlist.parts[i].realised =
            sallen_key().parts[i].realised * std::pow(factor, static_cast<double>(i) - 2.0);
        values.push_back(netlist.parts[i].realised);
      }
      const auto wanted = network_response(netlist, grid, {.ideal_opamps = ideal});
      const auto& got = of_parts.at(values);
      for (std::size_t i = 0; i < grid.size(); ++i)
        EXPECT_LT(std::abs(got[i] - wanted[i]), 1e-10 * std::abs(wanted[i]))
            << factor << " " << grid[i].value;
    }
  }
  netlist.parts.push_back({Part::Kind::diode, "D1", "", 0, "out", "0", "", 0.0, 0.0});
  EXPECT_THROW(ResponseOfParts(netlist, grid), std::invalid_argument);
}

TEST(Noise, OfAnRcIsKTOverC) {
  Netlist rc;
  rc.parts = {resistor("R", "in", "out", 1e4), capacitor("C", "out", "0", 1e-9)};
  const double corner = 1.0 / (2.0 * M_PI * 1e4 * 1e-9);
  const double rms = output_noise_rms(rc, {Hertz{corner * 1e-4}, Hertz{corner * 1e4}}, true, "out", 4001);
  EXPECT_NEAR(rms / std::sqrt(kBoltzmann * kKelvin / 1e-9), 1.0, 1e-3);
}

TEST(Noise, OfAnOpAmpIsItsOwnAndRisesBelowItsCorner) {
  Netlist follower;
  follower.parts = {resistor("Rl", "out", "0", 1e6)};
  follower.opamps = {{"U1", "", 0, "in", "out", "out"}};
  const double f = follower.opamp.voltage_noise_corner_hz / 3.0,
               own = follower.opamp.voltage_noise_v_per_rthz;
  EXPECT_NEAR(output_noise(follower, {Hertz{f}}, true).front() / own, 2.0, 1e-5);
  EXPECT_NEAR(output_noise(follower, {Hertz{f}}, false).front() / own, 1.0, 1e-5);
}

// At rest the shot noise of an ideal junction is the thermal noise of its slope.
TEST(Noise, OfADiodeAtRestIsThatOfItsSlope) {
  Netlist n;
  n.diode.emission = 1.0;
  n.parts = {{Part::Kind::diode, "D", "", 0, "out", "0", "", 0.0, 0.0}, resistor("R", "in", "out", 1e15)};
  const double slope = n.diode.saturation_a * kElectron / (kBoltzmann * kKelvin);
  const double density = output_noise(n, {Hertz{1e-3}}).front();
  EXPECT_NEAR(density / std::sqrt(4.0 * kBoltzmann * kKelvin / slope), 1.0, 1e-3);
}

}  // namespace
}  // namespace bodesmith::schematic
