#include "fpaa/grid_arithmetic.hpp"

#include <gtest/gtest.h>

#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

GridValues drawn(std::size_t points, std::size_t seed) {
  Random random(seed);
  GridValues out(points);
  for (std::complex<double>& value : out) value = {random.normal(), random.normal()};
  return out;
}

// Two points at a time, and what is left of an odd number of them: the bits of one point at a time.
TEST(GridArithmetic, IsThatOfEveryPoint) {
  const InD f{0.3, -1.2, 0.7}, g{1.5, 0.4, -0.2};
  for (const std::size_t points : {0UL, 1UL, 2UL, 7UL, 60UL}) {
    const GridValues a = drawn(points, 1), b = drawn(points, 2), d = drawn(points, 3);
    GridValues both = a, sum = d;
    multiply(both, b);
    add_product(sum, a, b);
    const GridValues inverse = inverse_of(f, d), quotient = negative_quotient(g, d, inverse),
                     change = negative_change(g, f, d, a, inverse);
    for (std::size_t k = 0; k < points; ++k) {
      const std::complex<double> below = f.at(d[k]);
      EXPECT_EQ(both[k], product(a[k], b[k]));
      EXPECT_EQ(sum[k], d[k] + product(a[k], b[k]));
      EXPECT_EQ(inverse[k], std::conj(below) / std::norm(below));
      EXPECT_EQ(quotient[k], -product(g.at(d[k]), inverse[k]));
      EXPECT_EQ(change[k], -product(g.at(d[k]) + product(a[k], below), inverse[k]));
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
