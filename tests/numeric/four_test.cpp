#include "numeric/four.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <vector>

#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// Four numbers, real and imaginary parts apart, from places that are aligned to one number only.
struct Drawn {
  explicit Drawn(Random& random) {
    for (int k = 0; k < 4; ++k) {
      re.push_back(4.0 * random.uniform() - 2.0);
      im.push_back(4.0 * random.uniform() - 2.0);
    }
  }
  ComplexFour four() const { return four_at(re.data() + 1, im.data() + 1); }
  Complex at(std::size_t k) const { return {re[k + 1], im[k + 1]}; }
  std::vector<double> re{0.0}, im{0.0};
};

TEST(ComplexFour, CountsAsOneComplexNumberDoes) {
  Random random(11);
  for (int trial = 0; trial < 100; ++trial) {
    const Drawn a(random), b(random);
    const ComplexFour product = a.four() * b.four(), scaled = a.four() * 0.3, one_over = inverse(a.four());
    std::vector<double> re(6, 7.0), im(6, 7.0);
    put(product, &re[1], &im[1]);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_LT(std::abs(Complex(re[k + 1], im[k + 1]) - a.at(k) * b.at(k)), 1e-15 * 8.0);
      EXPECT_EQ(Complex(scaled.re[k], scaled.im[k]), a.at(k) * 0.3);
      EXPECT_LT(std::abs(Complex(one_over.re[k], one_over.im[k]) * a.at(k) - 1.0), 1e-14);
    }
    for (const std::size_t outside : {0u, 5u}) EXPECT_EQ(re[outside] + im[outside], 14.0);
  }
}

}  // namespace
}  // namespace bodesmith
