#include "numeric/power_of_two_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

TEST(PowerOfTwoTransform, ALineStandsAloneInItsBin) {
  for (const std::size_t n : {32UL, 64UL, 128UL, 512UL, 4096UL, 131072UL}) {
    PowerOfTwoTransform transform(n);
    ASSERT_EQ(transform.size(), n);
    const std::size_t line = n / 4 + 1;
    std::vector<double> x(n);
    for (std::size_t i = 0; i < n; ++i)
      x[i] =
          0.5 +
          std::cos(2.0 * std::numbers::pi * static_cast<double>(i * line % n) / static_cast<double>(n) + 0.3);
    std::vector<Complex> bins(n / 2 + 1);
    transform.forward(x, bins.data());
    const double half = 0.5 * static_cast<double>(n);
    for (std::size_t k = 0; k <= n / 2; ++k) {
      const Complex wanted = k == line ? std::polar(half, 0.3) : (k == 0 ? Complex(half) : Complex(0.0));
      EXPECT_LT(std::abs(bins[k] - wanted), 1e-12 * half) << n << " " << k;
    }
  }
}

TEST(PowerOfTwoTransform, GivesTheSamplesBackAndKeepsTheirEnergy) {
  for (const std::size_t n : {32UL, 64UL, 1024UL, 65536UL}) {
    PowerOfTwoTransform transform(n);
    Random random(n);
    std::vector<double> x(n), again(n);
    for (double& v : x) v = random.normal();
    std::vector<Complex> bins(n / 2 + 1);
    transform.forward(x, bins.data());
    transform.inverse(bins.data(), again);
    double energy = 0.0, spectrum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(again[i], x[i], 1e-14 * std::log2(static_cast<double>(n))) << n;
      energy += x[i] * x[i];
    }
    for (std::size_t k = 0; k <= n / 2; ++k)
      spectrum += std::norm(bins[k]) * (k == 0 || 2 * k == n ? 1.0 : 2.0);
    EXPECT_NEAR(spectrum / static_cast<double>(n), energy, 1e-12 * energy);
  }
}

TEST(PowerOfTwoTransform, RefusesOtherLengths) {
  for (const std::size_t n : {0UL, 4UL, 16UL, 48UL, 1000UL}) EXPECT_THROW(PowerOfTwoTransform{n}, std::logic_error) << n;
}

}  // namespace
}  // namespace bodesmith
