#include "numeric/quadratic_program.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Longest step in [0, 1] that keeps value + step * change positive.
double step_to_boundary(const VectorXd& value, const VectorXd& change) {
  double step = 1.0;
  for (Index i = 0; i < value.size(); ++i) {
    if (change(i) < 0.0) step = std::min(step, -value(i) / change(i));
  }
  return step;
}

}  // namespace

QuadraticProgramResult solve_quadratic_program(const QuadraticProgram& p, const VectorXd& start) {
  const Index m = p.a.rows();
  VectorXd x = start;
  const double scale = 1.0 + p.c.cwiseAbs().maxCoeff();
  VectorXd s = (p.b - p.a * x).cwiseMax(1e-3 * (1.0 + p.b.cwiseAbs().maxCoeff()));
  VectorXd z = VectorXd::Constant(m, scale / static_cast<double>(m) + 1e-8);
  QuadraticProgramResult out;
  MatrixXd weighted;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const VectorXd dual = p.q * x + p.c + p.a.transpose() * z;
    const VectorXd primal = p.a * x + s - p.b;
    const double gap = s.dot(z) / static_cast<double>(m);
    const double objective = std::abs(0.5 * x.dot(p.q * x) + p.c.dot(x));
    if (gap * static_cast<double>(m) < 1e-9 * (1e-6 + objective) && primal.cwiseAbs().maxCoeff() < 1e-9 &&
        dual.cwiseAbs().maxCoeff() < 1e-9 * scale) {
      out.solved = true;
      break;
    }
    const VectorXd weight = z.cwiseQuotient(s);
    // The factors read the lower triangle alone.
    MatrixXd normal = p.q;
    const VectorXd root = weight.cwiseSqrt();
    weighted.noalias() = root.asDiagonal() * p.a;
    normal.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
    normal.diagonal().array() += 1e-14 * (1.0 + normal.diagonal().maxCoeff());
    const Eigen::LDLT<MatrixXd> factor(normal);
    // s z + s dz + z ds = target, ds = -primal - A dx, dz = (target - s z - z ds)/s.
    const auto direction = [&](const VectorXd& target, VectorXd& dx, VectorXd& ds, VectorXd& dz) {
      const VectorXd q = (target - s.cwiseProduct(z)).cwiseQuotient(s) + weight.cwiseProduct(primal);
      dx = factor.solve(-dual - p.a.transpose() * q);
      ds = -primal - p.a * dx;
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
