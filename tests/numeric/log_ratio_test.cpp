#include "numeric/log_ratio.hpp"

#include <gtest/gtest.h>

#include "numeric/random.hpp"

namespace bodesmith {
namespace {

TEST(LogRatio, IsTheComplexLogarithmOfTheQuotient) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto any = [&] { return 2.0 * random.uniform() - 1.0; };
    const std::complex<double> a(any(), any());
    // Every other pair as near as rounding allows to far apart.
    const std::complex<double> near = a * (1.0 + std::pow(10.0, -16.0 * random.uniform()) * any());
    const std::complex<double> b = i % 2 == 0 ? std::complex<double>(any(), any()) : near;
    const std::complex<long double> exact =
        std::log(std::complex<long double>(a) / std::complex<long double>(b));
    EXPECT_NEAR(log_ratio(a, b).real(), static_cast<double>(exact.real()), 1e-15);
    EXPECT_NEAR(log_ratio(a, b).imag(), static_cast<double>(exact.imag()), 1e-15);
  }
}

TEST(LogRatio, SizesBeyondTheSquareRootOfTheRange) {
  EXPECT_NEAR(log_ratio({0.0, 1e200}, 1e-80).real(), 280.0 * std::log(10.0), 1e-10);
  EXPECT_NEAR(log_ratio({0.0, 1e-200}, 1e-180).imag(), std::acos(0.0), 1e-15);
}

}  // namespace
}  // namespace bodesmith
