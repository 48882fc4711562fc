#include "numeric/optimisation/constrained_programs.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "numeric/four.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/matrix_products.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of the largest error at the start: a row that sticks out less is kept.
constexpr double kHolds = 1e-10;
/// An exchange by less than this would divide by rounding.
constexpr double kSmallestPivot = 1e-10;
/// Exchanges a number that is looked for; ten are many.
constexpr int kExchanges = 40;
/// Rows that a look at all of them may add to those that are watched, for each number that is looked for: a vertex has one
/// row each.
constexpr std::size_t kAdded = 2;

/// y += A x, columns of `rows` (a multiple of four) numbers each.
BODESMITH_CLONES void add_product(const double* a, std::size_t rows, std::size_t columns, const double* x,
                                  double* y) {
  std::size_t j = 0;
  for (; j + 4 <= columns; j += 4, a += 4 * rows) {
    for (std::size_t i = 0; i < rows; i += 4) {
      *four_at(y + i) += (x[j] * *four_at(a + i) + x[j + 1] * *four_at(a + rows + i)) +
                         (x[j + 2] * *four_at(a + 2 * rows + i) + x[j + 3] * *four_at(a + 3 * rows + i));
    }
  }
  for (; j < columns; ++j, a += rows) {
    for (std::size_t i = 0; i < rows; i += 4) *four_at(y + i) += x[j] * *four_at(a + i);
  }
}

/// Where |y| is largest, of equal ones the first; `count` a multiple of four. Anything where none is a number.
BODESMITH_CLONES std::size_t largest_of(const double* y, std::size_t count) {
  Four most = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < count; i += 4) {
    const Four here = *four_at(y + i);
    const Four size = here < 0.0 ? -here : here;
    most = size > most ? size : most;
  }
  const double largest = std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
  std::size_t at = 0;
  while (at < count && !(std::abs(y[at]) == largest)) ++at;
  return at < count ? at : 0;
}

/// The method at one vertex. An inequality is a'(x, t) <= b; its kind says which.
class Exchange {
 public:
  explicit Exchange(const LevelProgram& program)
      : p_(program),
        n_(program.slope.cols()),
        rows_(std_index(program.slope.rows())),
        padded_(in_fours(rows_)),
        slope_(padded_ * std_index(n_), 0.0),
        error_(padded_, 0.0),
        is_watched_(rows_, false),
        x_(n_ + 1),
        inverse_(MatrixXd::Zero(n_ + 1, n_ + 1)),
        multiplier_(n_ + 1),
        entering_(n_ + 1),
        weight_(n_ + 1) {
    for (Index j = 0; j < n_; ++j)
      std::copy_n(p_.slope.col(j).data(), rows_, slope_.data() + padded_ * std_index(j));
    std::copy_n(p_.error.data(), rows_, error_.data());
    scale_ = std::abs(error_[largest_of(error_.data(), padded_)]);
    holds_ = kHolds * std::max(scale_, std::numeric_limits<double>::min());
    begin();
  }

  LevelResult run() {
    const int most = kExchanges * (static_cast<int>(n_) + 1);
    for (int i = 0; i < most; ++i) {
      Inequality worst = most_violated();
      if (!(worst.by > holds_)) {
        if (!watch_more()) return result();
        worst = most_violated();
      }
      if (!exchange(worst)) break;
    }
    return {};
  }

 private:
  enum class Kind : std::uint8_t { row, bound, general };
  struct Inequality {
    Kind kind = Kind::row;
    double sign = 1.0;  ///< of a row's error, or of a bound: 1 the upper one
    Index at = 0;
    double by = 0.0;  ///< how far it is from being kept, > 0
  };

  /// The vertex where the largest error stands alone and every number at that bound to which it wants to go.
  void begin() {
    const auto row = static_cast<Index>(largest_of(error_.data(), padded_));
    const double sign = error_[std_index(row)] < 0.0 ? -1.0 : 1.0;
    double level = sign * p_.error(row);
    inverse_(n_, n_) = -1.0;
    multiplier_(n_) = 1.0;
    for (Index j = 0; j < n_; ++j) {
      const double rise = sign * p_.slope(row, j);
      const double price = rise + (p_.cost.size() > 0 ? p_.cost(j) : 0.0);
      const double bound = price > 0.0 ? -1.0 : 1.0;
      inverse_(j, j) = bound;
      inverse_(n_, j) = bound * rise;
      multiplier_(j) = std::abs(price);
      x_(j) = bound > 0.0 ? p_.upper(j) : p_.lower(j);
      level += rise * x_(j);
    }
    x_(n_) = level;
    watch_more();
  }

  static std::size_t in_fours(std::size_t count) { return (count + 3) / 4 * 4; }

  /// All rows anew. Of every stretch of one sign the row that sticks out most is watched from now on, the worst of them where
  /// there are many. False where none sticks out that is not watched.
  bool watch_more() {
    std::copy_n(p_.error.data(), rows_, error_.data());
    add_product(slope_.data(), padded_, std_index(n_), x_.data(), error_.data());
    std::vector<std::size_t> peaks;
    for (std::size_t i = 0; i < rows_;) {
      std::size_t peak = i;
      const bool below = error_[i] < 0.0;
      for (; i < rows_ && (error_[i] < 0.0) == below; ++i) {
        if (std::abs(error_[i]) > std::abs(error_[peak])) peak = i;
      }
      if (!is_watched_[peak] && std::abs(error_[peak]) - x_(n_) > holds_) peaks.push_back(peak);
    }
    if (peaks.empty()) return false;
    const std::size_t most = kAdded * std_index(n_ + 1);
    if (peaks.size() > most) {
      std::nth_element(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(most), peaks.end(),
                       [&](std::size_t a, std::size_t b) {
                         const double x = std::abs(error_[a]), y = std::abs(error_[b]);
                         return x > y || (x == y && a < b);
                       });
      peaks.resize(most);
      std::ranges::sort(peaks);
    }
    for (const std::size_t row : peaks) is_watched_[row] = true;
    watched_.insert(watched_.end(), peaks.begin(), peaks.end());
    const std::size_t count = in_fours(watched_.size());
    watched_slope_.assign(count * std_index(n_), 0.0);
    watched_error_.assign(count, 0.0);
    for (std::size_t k = 0; k < watched_.size(); ++k) {
      watched_error_[k] = error_[watched_[k]];
      for (std::size_t j = 0; j < std_index(n_); ++j)
        watched_slope_[j * count + k] = slope_[j * padded_ + watched_[k]];
    }
    return true;
  }

  /// Of what is watched.
  Inequality most_violated() {
    Inequality out{.by = -std::numeric_limits<double>::infinity()};
    if (!watched_.empty()) {
      const std::size_t peak = largest_of(watched_error_.data(), watched_error_.size());
      const double error = watched_error_[peak];
      out = {Kind::row, error < 0.0 ? -1.0 : 1.0, eigen_index(watched_[peak]), std::abs(error) - x_(n_)};
    }
    // The numbers count about as much as the level: both are in units of what is looked for.
    for (Index j = 0; j < n_; ++j) {
      if (x_(j) - p_.upper(j) > out.by) out = {Kind::bound, 1.0, j, x_(j) - p_.upper(j)};
      if (p_.lower(j) - x_(j) > out.by) out = {Kind::bound, -1.0, j, p_.lower(j) - x_(j)};
    }
    if (p_.b.size() == 0) return out;
    over_.noalias() = p_.a * x_.head(n_) - p_.b;
    Index k = 0;
    if (const double most = over_.maxCoeff(&k); most > out.by) out = {Kind::general, 1.0, k, most};
    return out;
  }

  /// Its row a'.
  void write_row(const Inequality& one) {
    entering_.setZero();
    switch (one.kind) {
      case Kind::row:
        entering_.head(n_) = one.sign * p_.slope.row(one.at).transpose();
        entering_(n_) = -1.0;
        break;
      case Kind::bound:
        entering_(one.at) = one.sign;
        break;
      case Kind::general:
        entering_.head(n_) = p_.a.row(one.at).transpose();
        break;
    }
  }

  /// False where none of the vertex can make room, or only by dividing by rounding.
  bool exchange(const Inequality& in) {
    write_row(in);
    weight_.noalias() = inverse_.transpose() * entering_;
    // Multipliers stay positive: the first that would not is left behind; of equal ones the safest.
    Index out = -1;
    double least = std::numeric_limits<double>::infinity();
    for (Index j = 0; j <= n_; ++j) {
      if (!(weight_(j) > kSmallestPivot)) continue;
      const double ratio = std::max(0.0, multiplier_(j)) / weight_(j);
      if (ratio < least || (ratio == least && weight_(j) > weight_(out))) {
        least = ratio;
        out = j;
      }
    }
    if (out < 0) return false;
    inverse_.col(out) /= weight_(out);
    for (Index j = 0; j <= n_; ++j) {
      if (j != out && weight_(j) != 0.0) inverse_.col(j) -= weight_(j) * inverse_.col(out);
    }
    multiplier_ -= least * weight_;
    multiplier_(out) = least;
    weight_ = -in.by * inverse_.col(out);
    x_ += weight_;
    add_product(watched_slope_.data(), watched_error_.size(), std_index(n_), weight_.data(),
                watched_error_.data());
    return true;
  }

  /// Sure of it: all rows anew.
  LevelResult result() const {
    LevelResult out{x_.head(n_).cwiseMax(p_.lower).cwiseMin(p_.upper), x_(n_), false};
    const double there = (p_.error + p_.slope * out.x).cwiseAbs().maxCoeff();
    out.solved = out.x.allFinite() && std::abs(there - out.level) <= 1e-7 * scale_;
    return out;
  }

  const LevelProgram& p_;
  Index n_;
  std::size_t rows_, padded_;
  std::vector<double> slope_;
  std::vector<double> error_;  ///< where all rows were looked at last
  std::vector<std::size_t> watched_;
  std::vector<bool> is_watched_;
  std::vector<double> watched_slope_, watched_error_;  ///< of these, the errors at x
  double scale_ = 0.0;
  double holds_ = 0.0;  ///< what sticks out less is kept
  VectorXd x_;          ///< and the level
  MatrixXd inverse_;    ///< of the vertex's rows
  VectorXd multiplier_;
  VectorXd entering_, weight_, over_;
};

}  // namespace

LevelResult solve_least_level(const LevelProgram& p) {
  const Index n = p.slope.cols();
  if (p.error.size() == 0 || p.error.size() != p.slope.rows() || p.lower.size() != n || p.upper.size() != n ||
      (p.cost.size() > 0 && p.cost.size() != n) || p.a.rows() != p.b.size() ||
      (p.b.size() > 0 && p.a.cols() != n))
    throw std::logic_error("smallest level: sizes differ");
  if (!p.error.allFinite() || !p.slope.allFinite()) return {};
  return Exchange(p).run();
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Longest step in [0, 1] that keeps value + step * change positive.
double step_to_boundary(const VectorXd& value, const VectorXd& change) {
  return 1.0 / std::max(1.0, -change.cwiseQuotient(value).minCoeff());
}

}  // namespace

QuadraticProgramResult solve_quadratic_program(const QuadraticProgram& p, const VectorXd& start) {
  const Index m = p.a.rows();
  const TallMatrix a(p.a);
  VectorXd x = start;
  const double scale = 1.0 + p.c.cwiseAbs().maxCoeff();
  VectorXd s = (p.b - a.times(x)).cwiseMax(1e-3 * (1.0 + p.b.cwiseAbs().maxCoeff()));
  VectorXd z = VectorXd::Constant(m, scale / static_cast<double>(m) + 1e-8);
  QuadraticProgramResult out;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const VectorXd dual = p.q * x + p.c + a.transpose_times(z);
    const VectorXd primal = a.times(x) + s - p.b;
    const double gap = s.dot(z) / static_cast<double>(m);
    const double objective = std::abs(0.5 * x.dot(p.q * x) + p.c.dot(x));
    if (gap * static_cast<double>(m) < 1e-9 * (1e-6 + objective) && primal.cwiseAbs().maxCoeff() < 1e-9 &&
        dual.cwiseAbs().maxCoeff() < 1e-9 * scale) {
      out.solved = true;
      break;
    }
    const VectorXd weight = z.cwiseQuotient(s);
    MatrixXd normal = p.q + a.gram(weight);
    normal.diagonal().array() += 1e-14 * (1.0 + normal.diagonal().maxCoeff());
    const Eigen::LDLT<MatrixXd> factor(normal);
    // s z + s dz + z ds = target, ds = -primal - A dx, dz = (target - s z - z ds)/s.
    const auto direction = [&](const VectorXd& target, VectorXd& dx, VectorXd& ds, VectorXd& dz) {
      const VectorXd q = (target - s.cwiseProduct(z)).cwiseQuotient(s) + weight.cwiseProduct(primal);
      dx = factor.solve(-dual - a.transpose_times(q));
      ds = -primal - a.times(dx);
      dz = (target - s.cwiseProduct(z) - z.cwiseProduct(ds)).cwiseQuotient(s);
    };
    VectorXd dx, ds, dz;
    direction(VectorXd::Zero(m), dx, ds, dz);
    if (!dx.allFinite()) break;
    const double affine = std::min(step_to_boundary(s, ds), step_to_boundary(z, dz));
    const double affine_gap = (s + affine * ds).dot(z + affine * dz) / static_cast<double>(m);
    const double centre = std::pow(affine_gap / gap, 3);
    const VectorXd target = VectorXd::Constant(m, centre * gap) - ds.cwiseProduct(dz);
    direction(target, dx, ds, dz);
    if (!dx.allFinite()) break;
    const double step_s = std::min(1.0, 0.995 * step_to_boundary(s, ds));
    const double step_z = std::min(1.0, 0.995 * step_to_boundary(z, dz));
    // One step for a quadratic objective, which couples x and z.
    const double step = std::min(step_s, step_z);
    x += step * dx;
    s += step * ds;
    z += step * dz;
  }
  out.x = x;
  out.multiplier = z;
  return out;
}

}  // namespace bodesmith
