#include "numeric/non_negative_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith {

NonNegativeResult solve_non_negative(const NonNegativeMap& map, const Eigen::VectorXd& b,
                                     const Eigen::VectorXd& start, const Eigen::VectorXd& scale,
                                     double tolerance, int iterations, double least_gain) {
  const Eigen::Index n = map.columns;
  NonNegativeResult out;
  Eigen::VectorXd work(n);
  const auto forward = [&](const Eigen::VectorXd& z, Eigen::VectorXd& y) {
    work = scale.cwiseProduct(z);
    map.apply(work, y);
  };
  const auto backward = [&](const Eigen::VectorXd& r, Eigen::VectorXd& g) {
    map.adjoint(r, g);
    g = g.cwiseProduct(scale);
  };
  // z = x / scale.
  Eigen::VectorXd z(n);
  for (Eigen::Index i = 0; i < n; ++i) z(i) = scale(i) > 0.0 ? std::max(start(i), 0.0) / scale(i) : 0.0;
  Eigen::VectorXd r(map.rows), g(n), p(n), ap(map.rows), phi(n), beta(n);
  backward(b, g);
  const double reference = std::max(g.norm(), std::numeric_limits<double>::min());

  // Largest eigenvalue by power iteration, from the gradient of b.
  double norm = 1.0;
  p = g / reference;
  for (int i = 0; i < 15; ++i) {
    forward(p, ap);
    backward(ap, phi);
    norm = phi.norm();
    if (!(norm > 0.0)) break;
    p = phi / norm;
  }
  const double fixed_step = 1.0 / std::max(1.1 * norm, std::numeric_limits<double>::min());

  forward(z, r);
  r -= b;
  backward(r, g);
  const auto split = [&] {
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool is_free = z(i) > 0.0;
      phi(i) = is_free ? g(i) : 0.0;
      beta(i) = is_free ? 0.0 : std::min(g(i), 0.0);
    }
  };
  split();
  p = phi;
  double cost_before = 0.5 * r.squaredNorm();
  for (int k = 0; k < iterations; ++k) {
    out.iterations = k;
    out.kkt = std::sqrt(phi.squaredNorm() + beta.squaredNorm()) / reference;
    if (out.kkt <= tolerance) {
      out.converged = true;
      break;
    }
    if (k % 50 == 49) {
      const double cost = 0.5 * r.squaredNorm();
      if (cost_before - cost < least_gain * cost_before) {
        out.converged = true;
        break;
      }
      cost_before = cost;
    }
    // Reduced free gradient: what a fixed step could really gain.
    double reduced = 0.0;
    for (Eigen::Index i = 0; i < n; ++i)
      if (z(i) > 0.0) reduced += phi(i) * std::min(z(i) / fixed_step, phi(i));
    if (beta.squaredNorm() <= reduced) {
      forward(p, ap);
      const double curvature = ap.squaredNorm();
      const double length = curvature > 0.0 ? g.dot(p) / curvature : 0.0;
      double feasible = std::numeric_limits<double>::infinity();
      for (Eigen::Index i = 0; i < n; ++i)
        if (p(i) > 0.0) feasible = std::min(feasible, z(i) / p(i));
      if (length <= feasible) {
        z -= length * p;
        r -= length * ap;
        backward(r, g);
        const Eigen::VectorXd old = phi;
        const double old_norm = old.squaredNorm();
        split();
        // Polak-Ribière form: forgives the slow loss of conjugacy.
        const double gamma = old_norm > 0.0 ? std::max(0.0, phi.dot(phi - old) / old_norm) : 0.0;
        for (Eigen::Index i = 0; i < n; ++i) p(i) = z(i) > 0.0 ? phi(i) + gamma * p(i) : 0.0;
        if (!(g.dot(p) > 0.0)) p = phi;
      } else {
        z -= feasible * p;
        r -= feasible * ap;
        backward(r, g);
        split();
        z = (z - fixed_step * phi).cwiseMax(0.0);
        forward(z, r);
        r -= b;
        backward(r, g);
        split();
        p = phi;
      }
    } else {
      forward(beta, ap);
      const double curvature = ap.squaredNorm();
      const double length = curvature > 0.0 ? g.dot(beta) / curvature : 0.0;
      z -= length * beta;  // beta ≤ 0 where z = 0: z grows
      r -= length * ap;
      backward(r, g);
      split();
      p = phi;
    }
  }
  out.x = scale.cwiseProduct(z.cwiseMax(0.0));
  out.cost = 0.5 * r.squaredNorm();
  return out;
}

}  // namespace bodesmith
