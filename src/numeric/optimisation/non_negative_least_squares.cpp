#include "numeric/optimisation/non_negative_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The normal equations with columns scaled to unit length (a tolerance then means the same for all), and the
/// set of unknowns that may move.
class ActiveSet {
 public:
  ActiveSet(const MatrixXd& gram, const VectorXd& rhs, const std::vector<bool>& free_sign)
      : n_(rhs.size()), free_sign_(free_sign), scale_(n_), passive_(std_index(n_), false) {
    for (Index i = 0; i < n_; ++i) scale_(i) = gram(i, i) > 0.0 ? 1.0 / std::sqrt(gram(i, i)) : 0.0;
    g_ = scale_.asDiagonal() * gram * scale_.asDiagonal();
    c_ = scale_.asDiagonal() * rhs;
    for (Index i = 0; i < n_; ++i) passive_[std_index(i)] = is_free(i) && scale_(i) > 0.0;
    x_ = solve_passive();
  }

  double largest_rhs() const { return c_.cwiseAbs().maxCoeff(); }
  VectorXd solution() const { return scale_.asDiagonal() * x_; }

  /// The bound that costs most, when its gradient is above `limit`: it may move from now on. False: none is.
  bool enter(double limit) {
    const VectorXd gradient = c_ - times(g_, x_);
    Index entering = -1;
    double best = limit;
    for (Index i = 0; i < n_; ++i) {
      if (!passive_[std_index(i)] && scale_(i) > 0.0 && !is_free(i) && gradient(i) > best) {
        best = gradient(i);
        entering = i;
      }
    }
    if (entering < 0) return false;
    passive_[std_index(entering)] = true;
    return true;
  }

  /// Goes to the minimum over what may move; what would turn negative on the way stays at 0.
  void settle() {
    for (;;) {
      const VectorXd z = solve_passive();
      double alpha = 1.0;
      Index leaving = -1;
      for (Index i = 0; i < n_; ++i) {
        if (!passive_[std_index(i)] || is_free(i) || z(i) > 0.0) continue;
        const double way = x_(i) - z(i);
        const double ratio = way > 0.0 ? x_(i) / way : 0.0;
        if (leaving < 0 || ratio < alpha) {
          alpha = ratio;
          leaving = i;
        }
      }
      if (leaving < 0) {
        x_ = z;
        return;
      }
      x_ += alpha * (z - x_);
      x_(leaving) = 0.0;
      passive_[std_index(leaving)] = false;
    }
  }

 private:
  bool is_free(Index i) const { return !free_sign_.empty() && free_sign_[std_index(i)]; }
  VectorXd solve_passive() const {
    std::vector<Index> index;
    for (Index i = 0; i < n_; ++i)
      if (passive_[std_index(i)]) index.push_back(i);
    VectorXd z = VectorXd::Zero(n_);
    if (index.empty()) return z;
    MatrixXd sub = g_(index, index);
    sub.diagonal().array() += 1e-14;  // two equal columns share the weight instead of making it infinite
    z(index) = solve_ldlt(sub, c_(index));
    return z;
  }

  Index n_;
  const std::vector<bool>& free_sign_;
  VectorXd scale_;
  std::vector<bool> passive_;
  MatrixXd g_;
  VectorXd c_;
  VectorXd x_;
};

}  // namespace

NonNegativeResult non_negative_least_squares(const MatrixXd& gram, const VectorXd& rhs,
                                             const std::vector<bool>& free_sign, double tolerance) {
  ActiveSet set(gram, rhs, free_sign);
  const double limit = tolerance * std::max(set.largest_rhs(), std::numeric_limits<double>::min());
  NonNegativeResult out;
  const auto most = static_cast<int>(3 * rhs.size() + 10);
  for (; out.iterations < most; ++out.iterations) {
    if (!set.enter(limit)) {
      out.termination = Termination::gradient;
      break;
    }
    set.settle();
  }
  out.x = set.solution();
  return out;
}

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
