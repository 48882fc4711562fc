#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "approximate/log_symmetric.hpp"

namespace bodesmith {
namespace {

// tanh(zeta/4) = m lambda with lambda the eigenvalues of Jacobi's matrix, whose trace is beta and whose square's trace is
// beta^2 + 2 sum (k - beta)(k + beta)/((2k - 1)(2k + 1)): to the digits of long double, pairs included.
TEST(PadePositions, KeepTheTracesOfTheirMatrix) {
  for (const long double beta : {0.2L, -0.7L, 0.999L, 1.6L, 2.3L, 3.7L}) {
    for (int order = 1; order <= 9; ++order) {
      const long double log_kappa = 2.5L;
      std::complex<long double> sum = 0.0L, squares = 0.0L;
      for (const auto& z : pade_positions_complex(log_kappa, beta, order)) {
        const std::complex<long double> lambda = std::tanh(0.25L * z) / std::tanh(0.25L * log_kappa);
        sum += lambda;
        squares += lambda * lambda;
      }
      long double wanted = beta * beta;
      for (int k = 1; k < order; ++k)
        wanted += 2.0L * (k - beta) * (k + beta) / ((2.0L * k - 1.0L) * (2.0L * k + 1.0L));
      EXPECT_LT(std::abs(sum - beta), 1e-17L * (1.0L + order)) << "beta " << beta << ", order " << order;
      EXPECT_LT(std::abs(squares - wanted), 1e-17L * (1.0L + order) * (1.0L + beta * beta))
          << "beta " << beta << ", order " << order;
    }
  }
}

}  // namespace
}  // namespace bodesmith
