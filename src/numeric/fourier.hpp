#pragma once

#include <complex>
#include <span>
#include <vector>

namespace bodesmith {

/// Forward transform X_k = sum x_n exp(-2 pi j k n/N) (not scaled), in place; N a power of two.
void fourier(std::vector<std::complex<double>>& x);
/// Back again, with 1/N.
void inverse_fourier(std::vector<std::complex<double>>& x);
/// Forward transform of a real signal of any length above 0 (Bluestein: as a convolution of a power of two).
std::vector<std::complex<double>> fourier_of_any_length(std::span<const double> x);

}  // namespace bodesmith
