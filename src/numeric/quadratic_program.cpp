#include "numeric/quadratic_program.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "numeric/tall_matrix.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Longest step in [0, 1] that keeps value + step * change positive.
double step_to_boundary(const VectorXd& value, const VectorXd& change) {
  return 1.0 / std::max(1.0, -change.cwiseQuotient(value).minCoeff());
}

/// The inequalities' matrix. Of rows that come in pairs one is kept: S x + l t and -S x + l t.
class Inequalities {
 public:
  explicit Inequalities(const QuadraticProgram& p)
      : pairs_(p.pairs),
        level_(p.level),
        alike_(pairs_ > 0 ? VectorXd(p.a.col(level_).head(pairs_)) : VectorXd()),
        pair_(opposite(p)),
        rest_(p.a.bottomRows(p.a.rows() - 2 * p.pairs)) {}

  VectorXd times(const VectorXd& x) const {
    if (pairs_ == 0) return rest_.times(x);
    VectorXd out(2 * pairs_ + rest_.rows());
    const VectorXd opposite = pair_.times(x);
    const VectorXd alike = alike_ * x(level_);
    out.head(pairs_) = alike + opposite;
    out.segment(pairs_, pairs_) = alike - opposite;
    out.tail(rest_.rows()) = rest_.times(x);
    return out;
  }
  VectorXd transpose_times(const VectorXd& z) const {
    if (pairs_ == 0) return rest_.transpose_times(z);
    const auto up = z.head(pairs_);
    const auto down = z.segment(pairs_, pairs_);
    VectorXd out = rest_.transpose_times(z.tail(rest_.rows())) + pair_.transpose_times(up - down);
    out(level_) += alike_.dot(up + down);
    return out;
  }
  MatrixXd gram(const VectorXd& w) const {
    if (pairs_ == 0) return rest_.gram(w);
    const VectorXd both = w.head(pairs_) + w.segment(pairs_, pairs_);
    MatrixXd out = rest_.gram(w.tail(rest_.rows())) + pair_.gram(both);
    const VectorXd mixed =
        pair_.transpose_times((w.head(pairs_) - w.segment(pairs_, pairs_)).cwiseProduct(alike_));
    out.col(level_) += mixed;
    out.row(level_) += mixed.transpose();
    out(level_, level_) += both.dot(alike_.cwiseAbs2());
    return out;
  }

 private:
  static MatrixXd opposite(const QuadraticProgram& p) {
    MatrixXd out = p.a.topRows(p.pairs);
    if (p.pairs > 0) out.col(p.level).setZero();
    return out;
  }

  Index pairs_;
  Index level_;
  VectorXd alike_;   ///< the column `level` of either
  TallMatrix pair_;  ///< the first of each two rows, with nothing in the column `level`
  TallMatrix rest_;
};

}  // namespace

QuadraticProgramResult solve_quadratic_program(const QuadraticProgram& p, const VectorXd& start) {
  const Index m = p.a.rows();
  const Inequalities a(p);
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
    if (gap * static_cast<double>(m) < p.gap * (1e-6 + objective) && primal.cwiseAbs().maxCoeff() < 1e-9 &&
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
