#include "numeric/fourier.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// The definition, in long double.
Complex bin_by_definition(const std::vector<Complex>& x, std::size_t k) {
  std::complex<long double> sum = 0.0L;
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < n; ++i) {
    const long double angle = -2.0L * std::numbers::pi_v<long double> * static_cast<long double>(k * i % n) /
                              static_cast<long double>(n);
    sum += std::complex<long double>(x[i]) * std::polar(1.0L, angle);
  }
  return Complex(sum);
}

double rms(const std::vector<Complex>& x) {
  double sum = 0.0;
  for (const Complex& v : x) sum += std::norm(v);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

std::vector<Complex> random_signal(std::size_t n, bool real) {
  Random random(n);
  std::vector<Complex> x(n);
  for (Complex& v : x) v = {random.normal(), real ? 0.0 : random.normal()};
  return x;
}

// Powers of two, even and odd products of small primes, primes that go through Bluestein's convolution.
const std::size_t kLengths[] = {1, 2, 3, 7, 12, 15, 16, 74, 97, 128, 202, 250, 1009, 1024, 1350};

TEST(Fourier, TransformIsItsDefinition) {
  for (const std::size_t n : kLengths) {
    const auto x = random_signal(n, false);
    const auto bins = fourier(x);
    ASSERT_EQ(bins.size(), n);
    const double scale = std::sqrt(static_cast<double>(n)) * rms(x);
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_LT(std::abs(bins[k] - bin_by_definition(x, k)), 5e-15 * scale) << n << " " << k;
    }
  }
}

TEST(Fourier, InverseGivesTheSignalBack) {
  for (const std::size_t n : kLengths) {
    const auto x = random_signal(n, false);
    const auto again = inverse_fourier(fourier(x));
    for (std::size_t i = 0; i < n; ++i) EXPECT_LT(std::abs(again[i] - x[i]), 5e-15 * (1.0 + rms(x))) << n;
  }
}

TEST(Fourier, HalfSpectrumOfARealSignal) {
  for (const std::size_t n : kLengths) {
    const auto x = random_signal(n, true);
    std::vector<double> real(n);
    for (std::size_t i = 0; i < n; ++i) real[i] = x[i].real();
    const auto all = fourier(x);
    const auto half = half_spectrum(real);
    ASSERT_EQ(half.size(), n / 2 + 1);
    const double scale = std::sqrt(static_cast<double>(n)) * rms(x);
    for (std::size_t k = 0; k <= n / 2; ++k)
      EXPECT_LT(std::abs(half[k] - all[k]), 5e-15 * scale) << n << " " << k;
    const auto again = from_half_spectrum(half, n);
    ASSERT_EQ(again.size(), n);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(again[i], real[i], 2e-14) << n;
  }
}

TEST(Fourier, TablesOfFewLengthsAreKept) {
  const auto held = [] {
    const struct mallinfo2 now = mallinfo2();
    return static_cast<double>(now.uordblks + now.hblkhd);
  };
  const double before = held();
  for (std::size_t n = 20000; n < 35000; n += 500) fourier(std::vector<Complex>(smooth_length(n)));
  EXPECT_LT(held() - before, 10.0 * 35000 * sizeof(Complex));  // of thirty lengths no more than ten
}

TEST(Fourier, NothingCannotBeTransformed) {
  EXPECT_THROW(fourier({}), std::logic_error);
  EXPECT_THROW(half_spectrum({}), std::logic_error);
}

TEST(Fourier, SmoothLengthsHaveSmallFactors) {
  EXPECT_EQ(smooth_length(1024), 1024U);
  EXPECT_EQ(smooth_length(1009), 1000U);
  EXPECT_EQ(smooth_length(13), 12U);
  EXPECT_EQ(smooth_length(1), 1U);
}

}  // namespace
}  // namespace bodesmith
