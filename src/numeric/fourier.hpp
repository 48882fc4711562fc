#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace bodesmith {

// The discrete Fourier transform X_k = sum_n x_n exp(-2 pi j k n/N), not scaled; its inverse has the 1/N.
// Lengths whose prime factors are small go through kissfft (in Eigen's unsupported module), others become a
// convolution of a power of two (Bluestein, IEEE Trans. Audio Electroacoust. 18 (1970) 451): O(N log N) for
// every N. std::logic_error for N = 0.

/// X of N complex numbers.
std::vector<std::complex<double>> fourier(std::vector<std::complex<double>> x);
/// x back from X.
std::vector<std::complex<double>> inverse_fourier(std::vector<std::complex<double>> bins);

/// Of N real numbers the bins 0 … N/2 (rounded down): the others are their conjugates.
std::vector<std::complex<double>> half_spectrum(std::span<const double> x);
/// The n real numbers back.
std::vector<double> from_half_spectrum(const std::vector<std::complex<double>>& bins, std::size_t n);

/// Largest even length <= n with no prime factor above 5 (fast to transform); n when there is none.
std::size_t smooth_length(std::size_t n);

}  // namespace bodesmith
