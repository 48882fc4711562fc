#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace bodesmith {

/// The discrete Fourier transform of a power of two of samples, by passes of four that leave everything in order (Stockham;
/// Cochran et al., Proc. IEEE 55 (1967) 1664), real and imaginary parts apart so that four numbers go through at once. Keeps its
/// sines and its room for the next samples; not for two threads at a time.
class PowerOfTwoTransform {
 public:
  /// Of n real samples, n >= 32.
  explicit PowerOfTwoTransform(std::size_t n);

  std::size_t size() const { return 2 * half_; }
  /// Bins 0 … n/2 of n real samples.
  void forward(std::span<const double> x, std::complex<double>* bins);
  /// The samples back.
  void inverse(const std::complex<double>* bins, std::span<double> x);
  /// X of n/2 complex samples, in place.
  void forward(std::span<std::complex<double>> x);

 private:
  struct Pass {
    std::size_t radix = 4;
    std::size_t length = 0;  ///< of the transforms that are left
    std::size_t stride = 1;
    std::vector<double> turns;  ///< re and im of w, w^2, w^3 for each number
  };
  void run();

  std::size_t half_;
  std::vector<Pass> passes_;
  std::vector<std::complex<double>> turn_;  ///< e^(-2 pi j k/n), k <= n/4
  std::vector<double> re_, im_, other_re_, other_im_;
};

}  // namespace bodesmith
