#include "simulate/record/modal_pairs.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::simulate {
namespace {

using ModalComplex = Complex;

/// Of the modes' sum, and of the transform itself, which initial states and constants pass through.
constexpr double kMaxPairCondition = 1e4;
constexpr double kMaxTransformCondition = 1e7;

double one_norm(const Eigen::MatrixXd& m) {
  return m.cwiseAbs().colwise().sum().maxCoeff();
}

/// Rows of T: left eigenvectors, the real ones first, then real and imaginary part of one of each pair.
struct LeftModes {
  Eigen::MatrixXd rows;
  std::vector<Complex> poles;  ///< real ones, then one of each pair
  std::size_t real = 0;
};

std::optional<LeftModes> left_modes(const StateSpace& system) {
  const Eigen::Index n = eigen_index(system.order());
  // Column-major, so the transpose of A: block by block in series A is lower triangular, its transpose upper, and the
  // eigenvalues of such a matrix are found without rounding.
  const Eigen::Map<const Eigen::MatrixXd> transposed(system.a.data(), n, n);
  const std::optional<EigenSystem> modes = eigen_system(transposed);
  if (!modes) return std::nullopt;
  LeftModes out;
  out.rows.resize(n, n);
  const Eigen::MatrixXcd& vectors = modes->vectors;
  Eigen::Index row = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex p = modes->values(k);
    if (p.imag() != 0.0) continue;
    out.poles.push_back(p);
    out.rows.row(row++) = vectors.col(k).real().transpose();
  }
  out.real = out.poles.size();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex p = modes->values(k);
    if (!(p.imag() > 0.0)) continue;
    out.poles.push_back(p);
    out.rows.row(row++) = vectors.col(k).real().transpose();
    out.rows.row(row++) = vectors.col(k).imag().transpose();
  }
  if (row != n || !out.rows.allFinite()) return std::nullopt;
  return out;
}

}  // namespace

void ModalSystem::find_condition() {
  double modes = std::abs(direct);
  for (std::size_t k = 0; k < poles.size(); ++k) {
    modes += (poles[k].imag() != 0.0 ? 2.0 : 1.0) * std::abs(residues[k] / poles[k]);
  }
  double max_gain = 0.0;
  const auto at = [&](double w) {
    ModalComplex h = direct;
    for (std::size_t k = 0; k < poles.size(); ++k) {
      h += residues[k] / (ModalComplex(0.0, w) - poles[k]);
      if (poles[k].imag() != 0.0) h += std::conj(residues[k]) / (ModalComplex(0.0, w) - std::conj(poles[k]));
    }
    max_gain = std::max(max_gain, std::abs(h));
  };
  at(0.0);
  for (const ModalComplex p : poles) at(std::abs(p));
  condition = poles.empty() ? 1.0 : modes / max_gain;
  if (!std::isfinite(condition)) condition = std::numeric_limits<double>::infinity();
}

ModalSystem ModalSystem::from(const StateSpace& system) {
  ModalSystem m;
  m.direct = system.d;
  if (system.order() == 0) return m;
  const Eigen::Index n = eigen_index(system.order());
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> a(
      system.a.data(), n, n);
  const std::optional<EigenSystem> modes = eigen_system(a);
  if (!modes) {
    m.condition = std::numeric_limits<double>::infinity();
    return m;
  }
  const Eigen::VectorXcd in = solve_lu(modes->vectors, as_eigen(system.b).cast<ModalComplex>());
  const Eigen::RowVectorXcd out = as_eigen(system.c).cast<ModalComplex>().transpose() * modes->vectors;
  for (Eigen::Index k = 0; k < n; ++k) {
    const ModalComplex p = modes->values(k);
    if (p.imag() < 0.0) continue;
    m.poles.push_back(p);
    m.residues.push_back(in(k)*out(k));
  }
  m.find_condition();
  return m;
}

void ModalPairs::to_modes(const double* x, double* w) const {
  const std::size_t n = transform.size() / std::max<std::size_t>(b.size(), 1);
  for (std::size_t i = 0; i < b.size(); ++i) {
    w[i] = 0.0;
    for (std::size_t j = 0; j < n; ++j) w[i] += transform[i * n + j] * x[j];
  }
}

std::optional<ModalPairs> modal_pairs(const StateSpace& system) {
  const std::size_t n = system.order();
  if (n == 0) return std::nullopt;
  const auto modes = left_modes(system);
  if (!modes) return std::nullopt;
  const Eigen::MatrixXd back = inverse(modes->rows);
  if (!back.allFinite() || !(one_norm(modes->rows) * one_norm(back) <= kMaxTransformCondition))
    return std::nullopt;
  const Eigen::VectorXd in = modes->rows * as_eigen(system.b);
  const Eigen::VectorXd out = back.transpose() * as_eigen(system.c);

  ModalPairs pairs;
  const std::size_t padded = modes->real % 2;
  const std::size_t states = n + padded;
  pairs.b.assign(states, 0.0);
  pairs.c.assign(states, 0.0);
  pairs.transform.assign(states * n, 0.0);
  pairs.blocks.assign(2 * states, 0.0);
  Eigen::VectorXd constant;
  if (!system.constant.empty()) {
    constant = modes->rows * as_eigen(system.constant);
    pairs.constant.assign(states, 0.0);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t to = i < modes->real ? i : i + padded;
    const Eigen::Index from = eigen_index(i);
    pairs.b[to] = in(from);
    pairs.c[to] = out(from);
    if (!pairs.constant.empty()) pairs.constant[to] = constant(from);
    for (std::size_t j = 0; j < n; ++j) pairs.transform[to * n + j] = modes->rows(from, eigen_index(j));
  }
  // What the modes add up to, for their condition: H = d + sum r/(s - p).
  ModalSystem sum;
  sum.direct = system.d;
  sum.poles = modes->poles;
  pairs.slowest_rad_s = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < modes->poles.size(); ++k) {
    const Complex p = modes->poles[k];
    pairs.slowest_rad_s = std::min(pairs.slowest_rad_s, -p.real());
    if (k < modes->real) {
      pairs.blocks[2 * k + (k % 2)] = p.real();  // element (k % 2, k % 2) of its block
      sum.residues.emplace_back(pairs.b[k] * pairs.c[k]);
      continue;
    }
    const std::size_t first = modes->real + padded + 2 * (k - modes->real);
    double* block = pairs.blocks.data() + 2 * first;
    block[0] = block[3] = p.real();
    block[1] = -p.imag();
    block[2] = p.imag();
    pairs.coupled = true;
    // (w1, w2) as the complex w1 + j w2, which obeys w' = p w + (b1 + j b2) u; y = Re((c1 - j c2) w).
    sum.residues.push_back(0.5 * Complex(pairs.b[first], pairs.b[first + 1]) *
                           Complex(pairs.c[first], -pairs.c[first + 1]));
  }
  sum.find_condition();
  pairs.condition = sum.condition;
  if (!(pairs.condition <= kMaxPairCondition) || !(pairs.slowest_rad_s > 0.0)) return std::nullopt;
  return pairs;
}

}  // namespace bodesmith::simulate
