#include "fpaa/device/mismatch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace bodesmith::fpaa {
namespace {

TEST(Mismatch, ACapacitorIsTheMeanOfItsUnits) {
  const MismatchModel model{0.5, 0.25};
  EXPECT_NEAR(model.relative_sigma(1.0), 0.005, 1e-15);
  EXPECT_NEAR(model.relative_sigma(25.0), 0.001, 1e-15);
  EXPECT_EQ(model.relative_sigma(0.0), 0.0);
  EXPECT_NEAR(model.drawn(25.0, 2.0), 25.0 * 1.002 + 0.25, 1e-12);
  EXPECT_EQ(model.drawn(0.0, 2.0), 0.0);
  EXPECT_EQ(model.drawn(1.0, -1e6), 0.0);
  EXPECT_NEAR(error_of_95_percent({3.0, -4.0}, 0.1), 5.0 + 0.1959964, 1e-7);
  const NoiseModel noise{50e-15, 300.0, 1.0};
  EXPECT_NEAR(noise.unit_noise_v(), std::sqrt(1.380649e-23 * 300.0 / 50e-15), 1e-18);
  EXPECT_NEAR(noise.microvolts(4.0), 2e6 * noise.unit_noise_v(), 1e-12);
  EXPECT_EQ(noise.microvolts(-1.0), 0.0);
}

// Units with independent errors: the covariance of the new capacitor's error with the old one's gives what is kept, the rest is spread.
TEST(Mismatch, ExchangedUnitsByCountingThem) {
  const auto held = [](int n, int unit, UnitArray array) {
    if (array == UnitArray::nested) return unit < n;
    int group = 0;
    while ((2 << group) - 1 <= unit) ++group;  // units 2^g - 1 … 2^(g+1) - 2 are the group of 2^g
    return ((n >> group) & 1) != 0;
  };
  for (const UnitArray array : {UnitArray::nested, UnitArray::binary}) {
    for (const auto& [from, to] : {std::pair(127, 128), {37, 40}, {40, 37}, {6, 3}, {1, 255}, {200, 72}}) {
      int shared = 0;
      for (int unit = 0; unit < 255; ++unit)
        shared += held(from, unit, array) && held(to, unit, array) ? 1 : 0;
      const double kept = static_cast<double>(shared) / from;
      const ExchangedUnits got = exchanged_units(from, to, array, 0.04);
      EXPECT_NEAR(got.kept, kept, 1e-15);
      // Var(new) = to; what the old error explains of it: shared^2/from.
      EXPECT_NEAR(got.variance, 0.04 * (to - static_cast<double>(shared) * shared / from), 1e-12)
          << from << " " << to;
    }
    for (const auto& [from, to] : {std::pair(50, 50), {0, 5}, {5, 0}}) {
      EXPECT_EQ(exchanged_units(from, to, array, 0.04).kept, 1.0);
      EXPECT_EQ(exchanged_units(from, to, array, 0.04).variance, 0.0);
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
