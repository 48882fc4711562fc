#include "numeric/optimisation/bounded_least_squares.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

Matrix to_eigen(const LongMatrix& a) {
  Matrix out(eigen_index(a.size()), eigen_index(a.empty() ? 0 : a.front().size()));
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < a[i].size(); ++j) out(eigen_index(i), eigen_index(j)) = a[i][j];
  }
  return out;
}

Vector to_eigen(const LongVector& b) {
  return Eigen::Map<const Vector>(b.data(), eigen_index(b.size()));
}

using Qr = Eigen::ColPivHouseholderQR<Matrix>;

/// qr.solve(b), one reflection after the other: Eigen compiles its blocks of them for many right sides with it, for seconds.
Vector solve(const Qr& qr, Vector b) {
  const Eigen::Index rank = qr.nonzeroPivots();
  Real room;
  for (Eigen::Index k = 0; k < rank; ++k) {
    const Eigen::Index rest = b.size() - k;
    b.tail(rest).applyHouseholderOnTheLeft(qr.matrixQR().col(k).tail(rest - 1), qr.hCoeffs()(k), &room);
  }
  Vector x = Vector::Zero(qr.cols());
  x.head(rank) = qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(b.head(rank));
  return qr.colsPermutation() * x;
}

Vector solve(const Matrix& a, const Vector& b) {
  const Qr qr(a);
  const Vector x = solve(qr, b);
  return x + solve(qr, b - a * x);
}

}  // namespace

LongVector least_squares(const LongMatrix& a, const LongVector& b) {
  const Vector x = solve(to_eigen(a), to_eigen(b));
  return {x.data(), x.data() + x.size()};
}

LongMatrix least_squares_inverse(const LongMatrix& a) {
  const Qr qr(to_eigen(a));
  LongMatrix out(std_index(qr.cols()), LongVector(a.size()));
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Vector column = solve(qr, Vector::Unit(qr.rows(), eigen_index(k)));
    for (std::size_t i = 0; i < out.size(); ++i) out[i][k] = column(eigen_index(i));
  }
  return out;
}

double condition_number(const LongMatrix& a) {
  const Eigen::VectorXd values = singular_values(to_eigen(a).cast<double>());
  const double min = values(values.size() - 1);
  return min > 0.0 ? values(0) / min : std::numeric_limits<double>::infinity();
}

namespace {

using Eigen::Index;

/// The run of BVLS: x, and for every unknown the bound it rests at (-1 lower, +1 upper, 0 free).
class BoundedSearch {
 public:
  BoundedSearch(Matrix a, Vector b, Vector lower, Vector upper)
      : a_(std::move(a)),
        b_(std::move(b)),
        lower_(std::move(lower)),
        upper_(std::move(upper)),
        x_(lower_),
        bound_(std_index(a_.cols()), -1),
        barred_(std_index(a_.cols()), false) {}

  void run() {
    const Index max_exchanges = 100 * (x_.size() + 1);
    for (Index exchange = 0; exchange < max_exchanges; ++exchange) {
      const std::optional<Index> entering = steepest();
      if (!entering) return;
      settle(*entering);
    }
  }

  BoundedSolution solution() const {
    BoundedSolution out;
    out.x.assign(x_.data(), x_.data() + x_.size());
    out.bound = bound_;
    const Vector downhill = a_.transpose() * (b_ - a_ * x_);
    for (Index i = 0; i < x_.size(); ++i) {
      const Real violation = at(i) == 0 ? std::abs(downhill(i)) : gain(i, downhill);
      out.optimality_residual = std::max(out.optimality_residual, violation);
    }
    return out;
  }

 private:
  /// Where the way from x to the free minimum meets its first bound.
  struct Stop {
    Real way = 1.0L;  ///< part of the way
    Index index = -1;
    int side = 0;
  };

  int& at(Index i) { return bound_[std_index(i)]; }
  int at(Index i) const { return bound_[std_index(i)]; }
  /// What leaving its bound would gain; negative: it is pressed there.
  Real gain(Index i, const Vector& downhill) const { return at(i) < 0 ? downhill(i) : -downhill(i); }

  /// The bound that is best left.
  std::optional<Index> steepest() const {
    const Vector downhill = a_.transpose() * (b_ - a_ * x_);
    std::optional<Index> enter;
    Real best = 1e-15L * (1.0L + b_.norm()) * (1.0L + a_.norm());
    for (Index i = 0; i < x_.size(); ++i) {
      if (at(i) == 0 || barred_[std_index(i)]) continue;
      if (gain(i, downhill) > best) {
        best = gain(i, downhill);
        enter = i;
      }
    }
    return enter;
  }

  std::vector<Index> free_unknowns() const {
    std::vector<Index> free;
    for (Index i = 0; i < x_.size(); ++i)
      if (at(i) == 0) free.push_back(i);
    return free;
  }

  Vector free_minimum(const std::vector<Index>& free) const {
    Vector rest = b_;
    for (Index i = 0; i < x_.size(); ++i)
      if (at(i) != 0) rest -= a_.col(i) * x_(i);
    const Matrix part = a_(Eigen::all, free);
    return solve(part, rest);
  }

  Stop first_bound(const std::vector<Index>& free, const Vector& target) const {
    Stop stop;
    for (std::size_t j = 0; j < free.size(); ++j) {
      const Real z = target(eigen_index(j));
      const Real lower = lower_(free[j]);
      const Real upper = upper_(free[j]);
      if (z >= lower && z <= upper) continue;
      const Real here = x_(free[j]);
      const Real step = z == here ? 0.0L : ((z < lower ? lower : upper) - here) / (z - here);
      if (step < stop.way || stop.index < 0)
        stop = {std::clamp(step, 0.0L, 1.0L), free[j], z < lower ? -1 : 1};
    }
    return stop;
  }

  /// Frees one unknown and goes to the minimum over all that are free; what meets a bound on the way stays.
  void settle(Index entering) {
    const int came_from = at(entering);
    at(entering) = 0;
    for (bool first = true;; first = false) {
      const std::vector<Index> free = free_unknowns();
      if (free.empty()) return;
      const Vector target = free_minimum(free);
      const Stop stop = first_bound(free, target);
      for (std::size_t j = 0; j < free.size(); ++j)
        x_(free[j]) += stop.way * (target(eigen_index(j)) - x_(free[j]));
      if (stop.index < 0) {
        barred_.assign(barred_.size(), false);
        return;
      }
      x_(stop.index) = stop.side < 0 ? lower_(stop.index) : upper_(stop.index);
      at(stop.index) = stop.side;
      if (first && stop.index == entering && stop.side == came_from) {
        barred_[std_index(entering)] = true;
        return;
      }
    }
  }

  Matrix a_;
  Vector b_;
  Vector lower_;
  Vector upper_;
  Vector x_;
  std::vector<int> bound_;
  std::vector<bool> barred_;  ///< freed in vain at this corner (rounding)
};

}  // namespace

BoundedSolution bounded_least_squares(const LongMatrix& a, const LongVector& b, const LongVector& lower,
                                      const LongVector& upper) {
  BoundedSearch search(to_eigen(a), to_eigen(b), to_eigen(lower), to_eigen(upper));
  search.run();
  return search.solution();
}

BoundedSolution bounded_least_squares(const LongMatrix& a, const LongVector& b, Real lower, Real upper) {
  const std::size_t unknowns = a.empty() ? 0 : a.front().size();
  return bounded_least_squares(a, b, LongVector(unknowns, lower), LongVector(unknowns, upper));
}

}  // namespace bodesmith
