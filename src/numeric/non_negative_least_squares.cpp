#include "numeric/non_negative_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/dense.hpp"
#include "numeric/index.hpp"

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

}  // namespace bodesmith
