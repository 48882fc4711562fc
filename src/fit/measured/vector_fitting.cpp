#include "fit/measured/vector_fitting.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;
using Poles = std::vector<Complex>;

/// Two real functions for a pair of poles, one for a real pole, at every sample; one column each.
Eigen::MatrixXcd partial_fractions(const std::vector<Complex>& s, const Poles& poles) {
  const Complex j(0.0, 1.0);
  Eigen::MatrixXcd out(eigen_index(s.size()), eigen_index(poles.size()));
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Eigen::Index row = eigen_index(i);
    for (std::size_t k = 0; k < poles.size(); ++k) {
      const Eigen::Index column = eigen_index(k);
      const Complex one = 1.0 / (s[i] - poles[k]);
      if (poles[k].imag() == 0.0) {
        out(row, column) = one;
        continue;
      }
      const Complex other = 1.0 / (s[i] - std::conj(poles[k]));
      out(row, column) = one + other;
      out(row, column + 1) = j * (one - other);
      ++k;
    }
  }
  return out;
}

/// Eigenvalues of A - b c^T/d: the zeros of d + c^T (s - A)^-1 b.
Poles zeros_of(const Poles& poles, const Eigen::VectorXd& c, double d) {
  const Eigen::Index n = c.size();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex p = poles[std_index(k)];
    a(k, k) = p.real();
    if (p.imag() == 0.0) continue;
    a(k, k + 1) = p.imag();
    a(k + 1, k) = -p.imag();
    a(k + 1, k + 1) = p.real();
    b(k) = 2.0;
    b(k + 1) = 0.0;
    ++k;
  }
  const Eigen::VectorXcd values = eigenvalues(a - b * c.transpose() / d);
  Poles out;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (values(i).imag() > 0.0) {
      out.push_back(values(i));
      out.push_back(std::conj(values(i)));
    }
    if (values(i).imag() == 0.0) out.push_back(values(i));
  }
  return out;
}

/// min |A x - b| from the normal equations with columns of length 1; directions that rounding fills are left out.
Eigen::VectorXd solve_scaled(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::MatrixXd normal = gram(a);
  Eigen::VectorXd right = transpose_times(a, b);
  Eigen::VectorXd scale(normal.rows());
  for (Eigen::Index i = 0; i < scale.size(); ++i) {
    scale(i) = normal(i, i) > 0.0 ? 1.0 / std::sqrt(normal(i, i)) : 0.0;
  }
  const SymmetricEigen eigen = symmetric_eigen(scale.asDiagonal() * normal * scale.asDiagonal());
  const Eigen::VectorXd projected = transpose_times(eigen.vectors, scale.cwiseProduct(right));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(scale.size());
  const double least = 1e-15 * eigen.values.maxCoeff();
  for (Eigen::Index i = 0; i < scale.size(); ++i) {
    if (eigen.values(i) > least) x += projected(i) / eigen.values(i) * eigen.vectors.col(i);
  }
  return scale.cwiseProduct(x);
}

class VectorFitter {
 public:
  VectorFitter(const ResponseSamples& samples, Poles poles) : samples_(samples), poles_(std::move(poles)) {}

  /// One round; how far the poles moved, relatively.
  double relocate() {
    const Eigen::MatrixXcd basis = partial_fractions(samples_.s, poles_);
    const Eigen::Index n = basis.cols();
    const Eigen::Index rows = basis.rows();
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * rows + 1, 2 * n + 2);
    double size = 0.0;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double weight = 1.0 / samples_.deviation[std_index(i)];
      const Complex h = samples_.response[std_index(i)];
      size += std::norm(weight * h);
      for (Eigen::Index k = 0; k <= n; ++k) {
        const Complex value = weight * (k < n ? basis(i, k) : Complex(1.0));
        put(a, i, rows, k, value);
        put(a, i, rows, n + 1 + k, -h * value);
      }
    }
    // Relaxation: the mean of Re sigma over the samples is 1.
    const double share = std::sqrt(size) / static_cast<double>(rows);
    for (Eigen::Index k = 0; k < n; ++k) a(2 * rows, n + 1 + k) = share * basis.col(k).real().sum();
    a(2 * rows, 2 * n + 1) = share * static_cast<double>(rows);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * rows + 1);
    b(2 * rows) = std::sqrt(size);
    const Eigen::VectorXd x = solve_scaled(a, b);
    double d = x(2 * n + 1);
    if (!(std::abs(d) > 1e-8)) d = std::copysign(1e-8, d);
    return move_to(zeros_of(poles_, x.segment(n + 1, n), d));
  }

  RationalRoots finish() const {
    const Eigen::MatrixXcd basis = partial_fractions(samples_.s, poles_);
    const Eigen::Index n = basis.cols();
    const Eigen::Index rows = basis.rows();
    Eigen::MatrixXd a(2 * rows, n + 1);
    Eigen::VectorXd b(2 * rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double weight = 1.0 / samples_.deviation[std_index(i)];
      for (Eigen::Index k = 0; k <= n; ++k) put(a, i, rows, k, weight * (k < n ? basis(i, k) : Complex(1.0)));
      const Complex h = weight * samples_.response[std_index(i)];
      b(i) = h.real();
      b(rows + i) = h.imag();
    }
    const Eigen::VectorXd x = solve_scaled(a, b);
    RationalRoots out;
    out.cost = (times(a, x) - b).squaredNorm();
    out.poles = poles_;
    const double reach = x.head(n).cwiseAbs().sum();
    out.gain = std::abs(x(n)) > 1e-12 * reach ? x(n) : std::copysign(1e-12 * reach, x(n));
    if (out.gain == 0.0) out.gain = 1e-300;
    out.zeros = zeros_of(poles_, x.head(n), out.gain);
    return out;
  }

 private:
  static void put(Eigen::MatrixXd& a, Eigen::Index row, Eigen::Index rows, Eigen::Index column,
                  Complex value) {
    a(row, column) = value.real();
    a(rows + row, column) = value.imag();
  }

  double move_to(Poles next) {
    for (Complex& p : next) {
      if (!std::isfinite(p.real()) || !std::isfinite(p.imag())) return 0.0;
      p = {-std::max(std::abs(p.real()), 1e-9 * std::abs(p)), p.imag()};
      if (p == Complex(0.0)) p = -1e-9;
    }
    // A pair that has just become real stands as two neighbours; order does not matter otherwise.
    double moved = next.size() == poles_.size() ? 0.0 : 1.0;
    for (const Complex& p : next) {
      double nearest = 1.0;
      for (const Complex& q : poles_) nearest = std::min(nearest, std::abs(p - q) / std::abs(p));
      moved = std::max(moved, nearest);
    }
    poles_ = std::move(next);
    return moved;
  }

  const ResponseSamples& samples_;
  Poles poles_;
};

}  // namespace

RationalRoots vector_fit(const ResponseSamples& samples, std::vector<std::complex<double>> poles,
                         int rounds) {
  VectorFitter fitter(samples, std::move(poles));
  for (int i = 0; i < rounds; ++i) {
    if (fitter.relocate() < 1e-7) break;
  }
  return fitter.finish();
}

}  // namespace bodesmith
