#include "schematic/ngspice/ngspice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.hpp"
#include "base/files.hpp"
#include "schematic/netlist.hpp"
#include "schematic/writers/spice_library.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::ngspice {
namespace {

// Gain-bandwidth, slew rate and swing as set (facts: 10 MHz, 20 V/us, +-14.1 V).
TEST(OpAmpMacro, BehavesAsSet) {
  if (!is_available()) GTEST_SKIP() << "ngspice is not installed";
  const schematic::OpAmpModel model;
  const std::string follower = schematic::opamp_subcircuit(model) +
                               "\n.subckt follower in out\nX1 in out out bodesmith_opamp\n.ends\n";
  const auto h = run_ac_of_text(follower, "follower.sub", {Hertz{1e3}, Hertz{1e7}}, "follower");
  EXPECT_NEAR(std::abs(h[0]), 1.0, 1e-5);
  EXPECT_NEAR(std::abs(h[1]), std::sqrt(0.5), 1e-3);
  const Transient step =
      run_transient("step\n" + follower + "V1 in 0 PWL(0 -10 1u -10 1.001u 10)\nX1 in out follower\n",
                    {"out"}, 5e-9, 4e-6, "follower.sub");
  double at_low = 0.0, at_high = 0.0;
  for (size_t i = 0; i < step.time_s.size(); ++i) {
    if (step.v[0][i] < -5.0) at_low = step.time_s[i];
    if (step.v[0][i] < 5.0) at_high = step.time_s[i];
  }
  EXPECT_NEAR(10.0 / (at_high - at_low) / model.slew_v_per_s, 1.0, 0.03);
  const DcSweep sweep =
      run_dc("clip\n" + follower + "V1 in 0 0\nX1 in out follower\n", "V1", -20, 20, 1, {"out"}, "x");
  EXPECT_NEAR(sweep.v[0].front(), -14.1, 0.01);
  EXPECT_NEAR(sweep.v[0].back(), 14.1, 0.01);
}

// Two neighbours share an analysis where they rise; any other stands alone.
TEST(Ngspice, FrequenciesMayComeInAnyOrder) {
  if (!is_available()) GTEST_SKIP() << "ngspice is not installed";
  const std::string lowpass = ".subckt lowpass in out\nR1 in out 1k\nC1 out 0 1u\n.ends\n";
  const std::vector<Hertz> grid = {{100.0}, {1e3}, {1e5}, {10.0}, {10.0}, {20.0}, {20.0000001}, {1.0}};
  const auto h = run_ac_of_text(lowpass, "lowpass.sub", grid);
  ASSERT_EQ(h.size(), grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::complex<double> exact = 1.0 / std::complex<double>(1.0, 1e-3 * grid[i].rad_s().value);
    EXPECT_LT(std::abs(h[i] / exact - 1.0), 1e-11) << grid[i].value;
  }
}

TEST(Ngspice, ComplaintsNameTheFile) {
  if (!is_available()) GTEST_SKIP() << "ngspice is not installed";
  try {
    run_ac_of_text(".subckt broken in out\nR1 in out nonsense_model\n.ends\n", "broken.sub", {Hertz{1.0}});
    FAIL() << "a broken library was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("broken.sub"), std::string::npos) << error.what();
  }
  EXPECT_THROW(run_ac_of_text("R1 a b 1\n", "empty.sub", {Hertz{1.0}}), InputError);
  EXPECT_THROW(list_subcircuits(".subckt a in out\n", "open.sub"), InputError);
  EXPECT_THROW(list_subcircuits(".ends\n", "closed.sub"), InputError);
}

// sqrt(4 k T R) of the 10 kohm that the capacitor lets through.
TEST(Ngspice, NoiseOfAnRcIsItsResistors) {
  if (!is_available()) GTEST_SKIP() << "ngspice is not installed";
  const std::string rc = ".subckt compensator in out\nR1 in out 10k\nC1 out 0 10n\n.ends\n";
  const NoiseSpectrum noise = run_noise_of_text(rc, {Hertz{10.0}, Hertz{1e5}}, 5, "rc.sub");
  ASSERT_EQ(noise.grid.size(), 21u);
  for (std::size_t i = 0; i < noise.grid.size(); ++i) {
    const double through = 1.0 / std::hypot(1.0, 1e-4 * noise.grid[i].rad_s().value);
    const double wanted = std::sqrt(4.0 * 1.380649e-23 * 300.15 * 1e4) * through;
    EXPECT_NEAR(noise.v_per_rthz[i] / wanted, 1.0, 1e-6);
  }
}

}  // namespace
}  // namespace bodesmith::ngspice
