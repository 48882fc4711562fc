#pragma once

#include <complex>
#include <vector>

namespace bodesmith::simulate {

/// Forward transform X_k = sum x_n exp(-2 pi j k n/N) (not scaled), in place; N a power of two.
void fourier(std::vector<std::complex<double>>& x);
/// Back again, with 1/N.
void inverse_fourier(std::vector<std::complex<double>>& x);

}  // namespace bodesmith::simulate
