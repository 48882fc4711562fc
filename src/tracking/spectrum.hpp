#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "numeric/fourier.hpp"

namespace bodesmith::tracking {

using Complex = std::complex<double>;

/// Of a power of two of samples; not scaled.
inline std::vector<Complex> spectrum(const std::vector<double>& x) {
  return fourier({x.begin(), x.end()});
}

inline std::vector<double> samples_of(const std::vector<Complex>& bins) {
  const std::vector<Complex> x = inverse_fourier(bins);
  std::vector<double> out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) out[i] = x[i].real();
  return out;
}

/// Harmonic number that bin k of n stands for.
inline double harmonic_of_bin(std::size_t k, std::size_t n) {
  return k <= n / 2 ? static_cast<double>(k) : static_cast<double>(k) - static_cast<double>(n);
}

}  // namespace bodesmith::tracking
