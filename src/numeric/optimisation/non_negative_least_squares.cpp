#include "numeric/optimisation/non_negative_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// MPRGP over z = x/scale, residual r = A x − b and gradient g.
class ReducedGradientProjections {
 public:
  ReducedGradientProjections(const LinearMap& map, const VectorXd& b, const VectorXd& start,
                             const VectorXd& scale);

  double kkt() const { return std::sqrt(phi_.squaredNorm() + beta_.squaredNorm()) / reference_; }
  double cost() const { return 0.5 * r_.squaredNorm(); }
  VectorXd solution() const { return scale_.cwiseProduct(z_.cwiseMax(0.0)); }
  void iterate() {
    if (beta_.squaredNorm() <= reduced_gain()) {
      conjugate_step();
    } else {
      release_bounds();
    }
  }

 private:
  void forward(const VectorXd& z, VectorXd& y) {
    work_ = scale_.cwiseProduct(z);
    map_.apply(work_, y);
  }
  void backward(const VectorXd& r, VectorXd& g) {
    map_.adjoint(r, g);
    g = g.cwiseProduct(scale_);
  }
  double largest_eigenvalue();
  /// The gradient's part on the free variables, and its part that would release a bound.
  void split();
  double reduced_gain() const;
  void conjugate_step();
  void expand(double feasible);
  void release_bounds();

  const LinearMap& map_;
  const VectorXd& b_;
  const VectorXd& scale_;
  Index n_;
  VectorXd work_, z_, r_, g_, p_, ap_, phi_, beta_;
  double reference_ = 1.0;
  double fixed_step_ = 1.0;
};

ReducedGradientProjections::ReducedGradientProjections(const LinearMap& map, const VectorXd& b,
                                                       const VectorXd& start, const VectorXd& scale)
    : map_(map),
      b_(b),
      scale_(scale),
      n_(map.columns),
      work_(n_),
      z_(n_),
      r_(map.rows),
      g_(n_),
      p_(n_),
      ap_(map.rows),
      phi_(n_),
      beta_(n_) {
  for (Index i = 0; i < n_; ++i) z_(i) = scale(i) > 0.0 ? std::max(start(i), 0.0) / scale(i) : 0.0;
  backward(b_, g_);
  reference_ = std::max(g_.norm(), std::numeric_limits<double>::min());
  fixed_step_ = 1.0 / std::max(1.1 * largest_eigenvalue(), std::numeric_limits<double>::min());
  forward(z_, r_);
  r_ -= b_;
  backward(r_, g_);
  split();
  p_ = phi_;
}

/// By power iteration, from the gradient of b.
double ReducedGradientProjections::largest_eigenvalue() {
  double norm = 1.0;
  p_ = g_ / reference_;
  for (int i = 0; i < 15; ++i) {
    forward(p_, ap_);
    backward(ap_, phi_);
    norm = phi_.norm();
    if (!(norm > 0.0)) break;
    p_ = phi_ / norm;
  }
  return norm;
}

void ReducedGradientProjections::split() {
  for (Index i = 0; i < n_; ++i) {
    const bool is_free = z_(i) > 0.0;
    phi_(i) = is_free ? g_(i) : 0.0;
    beta_(i) = is_free ? 0.0 : std::min(g_(i), 0.0);
  }
}

/// Reduced free gradient: what a fixed step could really gain.
double ReducedGradientProjections::reduced_gain() const {
  double reduced = 0.0;
  for (Index i = 0; i < n_; ++i)
    if (z_(i) > 0.0) reduced += phi_(i) * std::min(z_(i) / fixed_step_, phi_(i));
  return reduced;
}

void ReducedGradientProjections::conjugate_step() {
  forward(p_, ap_);
  const double curvature = ap_.squaredNorm();
  const double length = curvature > 0.0 ? g_.dot(p_) / curvature : 0.0;
  double feasible = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < n_; ++i)
    if (p_(i) > 0.0) feasible = std::min(feasible, z_(i) / p_(i));
  if (length > feasible) return expand(feasible);
  z_ -= length * p_;
  r_ -= length * ap_;
  backward(r_, g_);
  const VectorXd old = phi_;
  const double old_norm = old.squaredNorm();
  split();
  // Polak-Ribière form: forgives the slow loss of conjugacy.
  const double gamma = old_norm > 0.0 ? std::max(0.0, phi_.dot(phi_ - old) / old_norm) : 0.0;
  for (Index i = 0; i < n_; ++i) p_(i) = z_(i) > 0.0 ? phi_(i) + gamma * p_(i) : 0.0;
  if (!(g_.dot(p_) > 0.0)) p_ = phi_;
}

/// To the nearest bound, and from there a fixed step along the free gradient, projected.
void ReducedGradientProjections::expand(double feasible) {
  z_ -= feasible * p_;
  r_ -= feasible * ap_;
  backward(r_, g_);
  split();
  z_ = (z_ - fixed_step_ * phi_).cwiseMax(0.0);
  forward(z_, r_);
  r_ -= b_;
  backward(r_, g_);
  split();
  p_ = phi_;
}

void ReducedGradientProjections::release_bounds() {
  forward(beta_, ap_);
  const double curvature = ap_.squaredNorm();
  const double length = curvature > 0.0 ? g_.dot(beta_) / curvature : 0.0;
  z_ -= length * beta_;  // beta ≤ 0 where z = 0: z grows
  r_ -= length * ap_;
  backward(r_, g_);
  split();
  p_ = phi_;
}

}  // namespace

NonNegativeResult non_negative_least_squares(const LinearMap& map, const VectorXd& b, const VectorXd& start,
                                             const VectorXd& scale, const NonNegativeOptions& options) {
  ReducedGradientProjections search(map, b, start, scale);
  NonNegativeResult out;
  double cost_before = search.cost();
  for (int k = 0; k < options.max_iterations; ++k) {
    out.iterations = k;
    out.kkt = search.kkt();
    if (out.kkt <= options.tolerance) {
      out.termination = Termination::gradient;
      break;
    }
    if (k % 50 == 49) {
      const double cost = search.cost();
      if (cost_before - cost < options.min_gain * cost_before) {
        out.termination = Termination::cost;
        break;
      }
      cost_before = cost;
    }
    search.iterate();
  }
  out.x = search.solution();
  out.cost = search.cost();
  return out;
}

}  // namespace bodesmith
