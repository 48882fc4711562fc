#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "approximate/all_methods.hpp"
#include "approximate/log_symmetric.hpp"
#include "base/error.hpp"

namespace bodesmith {

// The Thiele fraction through 2n + 1 values loses all digits from order 7 on. P^beta is (up to a map) a
// Stieltjes function, so its interpolant has interlaced real roots, and by the symmetry of the nodes mirror
// images: n unknown positions meet n nodes above the centre (the centre itself holds by symmetry). Newton's
// method on them is well conditioned.
NormalisedApproximation matsuda(const ApproximationTask& task) {
  const int n = task.order;
  const long double log_kappa = std::log(static_cast<long double>(task.kappa));
  const long double beta = task.beta;
  std::vector<long double> zeta = elliptic_positions(log_kappa, beta, n);
  std::vector<long double> node(static_cast<size_t>(n));
  for (int j = 0; j < n; ++j)
    node[static_cast<size_t>(j)] = 0.5L * log_kappa * (j + 1) / n;  // ln s, up to the corner
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  Matrix slope(n, n);
  Vector miss(n);
  for (int iteration = 0; iteration < 60; ++iteration) {
    for (int j = 0; j < n; ++j) {
      const long double y = node[static_cast<size_t>(j)];
      long double e = beta * half_lead(y, 0.5L * log_kappa);
      for (int k = 0; k < n; ++k) {
        const long double z = 0.5L * zeta[static_cast<size_t>(k)];
        e -= half_lead(y, z);
        slope(j, k) = 0.5L * half_lead_slope(y, std::abs(z));
      }
      miss(j) = e;
    }
    const Vector step = slope.fullPivLu().solve(miss);
    const long double largest = step.cwiseAbs().maxCoeff();
    const long double scale = largest > 1.0L ? 1.0L / largest : 1.0L;
    for (int k = 0; k < n; ++k) zeta[static_cast<size_t>(k)] += scale * step(k);
    if (largest < 1e-15L * (1.0L + log_kappa)) break;
  }
  if (!std::all_of(zeta.begin(), zeta.end(), [](long double z) { return std::isfinite(z); })) {
    throw DesignError("matsuda did not converge for this term, expected a lower order or another method");
  }
  return from_log_positions(zeta, log_kappa, beta);
}

}  // namespace bodesmith
