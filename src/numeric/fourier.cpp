#include "numeric/fourier.hpp"

#include <bit>
#include <numbers>
#include <stdexcept>

namespace bodesmith {

void fourier(std::vector<std::complex<double>>& x) {
  const std::size_t n = x.size();
  if (n == 0 || (n & (n - 1)) != 0)
    throw std::logic_error("the length of a Fourier transform must be a power of two");
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  // One exact table: running products would lose digits.
  std::vector<std::complex<double>> turn(n / 2);
  for (std::size_t k = 0; k < n / 2; ++k) {
    turn[k] = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  }
  for (std::size_t length = 2; length <= n; length <<= 1) {
    const std::size_t stride = n / length;
    for (std::size_t i = 0; i < n; i += length) {
      for (std::size_t k = 0; k < length / 2; ++k) {
        const auto a = x[i + k];
        const auto w = turn[k * stride];
        const auto c = x[i + k + length / 2];
        const std::complex<double> b(c.real() * w.real() - c.imag() * w.imag(),
                                     c.real() * w.imag() + c.imag() * w.real());
        x[i + k] = a + b;
        x[i + k + length / 2] = a - b;
      }
    }
  }
}

void inverse_fourier(std::vector<std::complex<double>>& x) {
  for (auto& v : x) v = std::conj(v);
  fourier(x);
  const double scale = 1.0 / static_cast<double>(x.size());
  for (auto& v : x) v = std::conj(v) * scale;
}

std::vector<std::complex<double>> fourier_of_any_length(std::span<const double> x) {
  const std::size_t n = x.size();
  if (n == 0) throw std::logic_error("a Fourier transform needs at least one sample");
  // n k = (n^2 + k^2 - (k - n)^2)/2; squares are taken modulo 2 n so that the angles keep their digits.
  std::vector<std::complex<double>> chirp(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t square = k * k % (2 * n);
    chirp[k] = std::polar(1.0, -std::numbers::pi * static_cast<double>(square) / static_cast<double>(n));
  }
  const std::size_t size = std::bit_ceil(2 * n - 1);
  std::vector<std::complex<double>> signal(size);
  std::vector<std::complex<double>> kernel(size);
  for (std::size_t k = 0; k < n; ++k) {
    signal[k] = x[k] * chirp[k];
    kernel[k] = std::conj(chirp[k]);
    if (k > 0) kernel[size - k] = kernel[k];
  }
  fourier(signal);
  fourier(kernel);
  for (std::size_t k = 0; k < size; ++k) signal[k] *= kernel[k];
  inverse_fourier(signal);
  signal.resize(n);
  for (std::size_t k = 0; k < n; ++k) signal[k] *= chirp[k];
  return signal;
}

}  // namespace bodesmith
