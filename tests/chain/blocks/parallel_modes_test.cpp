// Modes side by side, and zeros in the right half-plane.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.hpp"
#include "chain/kernel.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"

namespace bodesmith::chain {
namespace {

using Complex = std::complex<double>;

Block two_modes() {
  return make_block("parallel_modes")
      .set("gains", std::vector<double>{0.4, -0.15})
      .set("natural_frequencies_hz", std::vector<double>{30.0, 70.0})
      .set("damping_ratios", std::vector<double>{0.02, 0.05});
}

Block resonator(double gain, double hz, double damping) {
  return make_block("resonator")
      .set("gain", gain)
      .set("natural_frequency_hz", hz)
      .set("damping_ratio", damping);
}

Complex at(const Block& block, double hz) {
  return *block.response(Hertz{hz}.rad_s());
}

void expect_kernel_is_response(const Block& block) {
  const auto kernel = std::get<LinearKernel>(block.kernel());
  for (double hz : {0.5, 29.0, 31.0, 69.0, 80.0, 700.0}) {
    const Complex by_states = response(kernel, Complex(0.0, Hertz{hz}.rad_s().value));
    EXPECT_LT(std::abs(by_states - at(block, hz)), 1e-12 * std::abs(by_states)) << block.type_name() << hz;
  }
}

TEST(ParallelModes, StatesAndFormulaAreOneResponse) {
  expect_kernel_is_response(two_modes());
  expect_kernel_is_response(two_modes().set("resonator_hz", 45.0).set("resonator_damping_ratio", 0.03));
  expect_kernel_is_response(
      make_block("right_half_plane_zero").set("right_zero_hz", 40.0).set("pole_hz", 90.0));
}

TEST(ParallelModes, AreASumOfResonatorsInParallelWithThePath) {
  for (double hz : {3.0, 30.0, 41.0, 90.0}) {
    const Complex sum = 1.0 + at(resonator(0.4, 30.0, 0.02), hz) + at(resonator(-0.15, 70.0, 0.05), hz);
    EXPECT_LT(std::abs(at(two_modes(), hz) - sum), 1e-12);
  }
}

TEST(ParallelModes, InParallelWithAResonatorTheirGainsArePartsOfItsGain) {
  const auto beside = two_modes().set("resonator_hz", 12.0).set("resonator_damping_ratio", 0.1);
  for (double hz : {3.0, 12.0, 30.0, 41.0, 90.0}) {
    const Complex first = at(resonator(2.0, 12.0, 0.1), hz);
    const Complex sum = first + at(resonator(0.8, 30.0, 0.02), hz) + at(resonator(-0.3, 70.0, 0.05), hz);
    EXPECT_LT(std::abs(first * at(beside, hz) - sum), 1e-12 * std::abs(sum));
  }
}

TEST(ParallelModes, ASlowModeSaysHowLongItRings) {
  EXPECT_NEAR(two_modes().slowest_time_constant_s(), 1.0 / (Hertz{30.0}.rad_s().value * 0.02), 1e-12);
}

TEST(ParallelModes, ListsOfDifferentLengthsAreRefused) {
  EXPECT_TRUE(two_modes().set("gains", std::vector<double>{0.4}).validate().has_value());
  EXPECT_FALSE(two_modes().validate().has_value());
}

TEST(ParallelModes, AreWrittenAndReadBack) {
  Chain chain{{two_modes().set("resonator_hz", 12.0).set("resonator_damping_ratio", 0.1),
               make_block("right_half_plane_zero").set("right_zero_hz", 40.0).set("pole_hz", 90.0)}};
  const std::string text = model_text(chain);
  EXPECT_EQ(model_text(model_from_node(parse_toml(text, "model.toml"))), text);
}

TEST(RightHalfPlaneZero, WithEqualCornersPassesAll) {
  const auto block = make_block("right_half_plane_zero").set("right_zero_hz", 50.0).set("pole_hz", 50.0);
  for (double hz : {1.0, 50.0, 400.0}) EXPECT_NEAR(std::abs(at(block, hz)), 1.0, 1e-12);
  EXPECT_NEAR(std::arg(at(block, 50.0)), -std::acos(0.0), 1e-12);
}

}  // namespace
}  // namespace bodesmith::chain
