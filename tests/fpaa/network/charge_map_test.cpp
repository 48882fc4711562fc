#include <gtest/gtest.h>

#include <cmath>

#include "fpaa/network/clocked_network.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kThermal = 1.380649e-23 * 300.15;  ///< kT of ngspice's 27 degrees, J

/// Mean square at the output of a circuit of resistors and capacitors: ngspice's density over all frequencies.
double mean_square(const std::string& circuit) {
  const ngspice::NoiseSpectrum noise = ngspice::run_noise_of_text(
      ".subckt compensator in out\n" + circuit + ".ends\n", {{1.0}, {1e14}}, 50, "switches");
  double out = 0.0;
  for (std::size_t k = 1; k < noise.grid.size(); ++k) {
    const double a = noise.v_per_rthz[k - 1] * noise.v_per_rthz[k - 1];
    const double b = noise.v_per_rthz[k] * noise.v_per_rthz[k];
    // Straight in double logarithm.
    const double slope = std::log(b / a) / std::log(noise.grid[k].value / noise.grid[k - 1].value) + 1.0;
    const double from = a * noise.grid[k - 1].value;
    const double to = b * noise.grid[k].value;
    out += std::abs(slope) < 1e-6 ? from * std::log(noise.grid[k].value / noise.grid[k - 1].value)
                                  : (to - from) / slope;
  }
  return out;
}

/// A low pass of 1 pF branches on 2 pF, its input at ground. What the switches leave when a phase ends is what they make
/// while they stand still: resistors, whose noise ngspice knows exactly. (Its transient noise needs steps far below the
/// switches' time constants: at a fifth of them it is half a decibel low, and minutes of it leave a quarter of chance.)
TEST(SwitchedNoise, ALowPassIsWhatNgspiceMakesOfItsPhases) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const std::string input = "Rin in 0 1e12\n";
  const double phase1 = mean_square(input +
                                    "Ra1 0 ua 1k\nCa ua wa 1p\nRa2 wa n 1k\nRb1 out ub 1k\nCb ub wb 1p\n"
                                    "Rb2 wb n 1k\nCint out n 2p\nEop out 0 0 n 1e7\n");
  const double phase2 = mean_square(input + "R1 0 u 1k\nCa u w 1p\nR2 w 0 1k\nEout out 0 u w 1\n");
  EXPECT_NEAR(phase2 * 1e-12 / kThermal, 1.0, 1e-3);  // kT/C

  fpaa::StageSwitches stage;
  using fpaa::PlateNode;
  stage.capacitors = {fpaa::switched_branch("Cin", 1, PlateNode::input()),
                      fpaa::switched_branch("Cout", 1, PlateNode::opamp()),
                      fpaa::static_branch("Cint", 2, PlateNode::opamp())};
  const fpaa::ClockedNetwork network(fpaa::circuit_of(stage), {2}, true);  // a unit: 1 pF
  const auto& phases = network.intervals();
  // Charges in sqrt(kT pF): on Cint at the end of phase 1, on both branches at the end of phase 2. (2 kT C a branch, as
  // books have it, would be 2 in phase 1 too.)
  const double cint = 4.0 * phase1 * 1e-12 / kThermal;
  const double branches = 2.0 * phase2 * 1e-12 / kThermal;
  EXPECT_NEAR(phases[0].noise(0, 0) / cint, 1.0, 1e-3);
  EXPECT_NEAR(phases[1].noise(0, 0) / branches, 1.0, 1e-3);

  // What stands on Cint through phase 2: it keeps two thirds of its charge and of the branches' in every phase 1.
  double charge = 0.0;
  double held = 0.0;
  double wanted = 0.0;
  for (int n = 0; n < 200; ++n) {
    wanted = phases[1].c(0, 0) * phases[1].c(0, 0) * charge;
    for (const std::size_t p : {1U, 0U})
      charge = phases[p].m(0, 0) * phases[p].m(0, 0) * charge + phases[p].noise(0, 0);
    held = 4.0 / 9.0 * (held + branches) + cint;
  }
  EXPECT_NEAR(10.0 * std::log10(held / 4.0 / wanted), 0.0, 0.01);
}

}  // namespace
}  // namespace bodesmith::fpaa
