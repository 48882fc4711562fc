#include "numeric/linear_algebra/dense.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/whole_number.hpp"

template void Eigen::PartialPivLU<Eigen::MatrixXd>::compute();

namespace bodesmith {

Eigen::MatrixXd gram(const Eigen::MatrixXd& a) {
  return a.transpose() * a;
}

Eigen::VectorXd transpose_times(const Eigen::MatrixXd& a, const Eigen::VectorXd& v) {
  return a.transpose() * v;
}

Eigen::VectorXd times(const Eigen::MatrixXd& a, const Eigen::VectorXd& v) {
  return a * v;
}

Eigen::MatrixXd times(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a * b;
}

Eigen::MatrixXd cholesky_factor(const Eigen::MatrixXd& a) {
  return a.llt().matrixL();
}

Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& l, const Eigen::MatrixXd& b) {
  return l.triangularView<Eigen::Lower>().solve(b);
}

Eigen::VectorXd solve_ldlt(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}

Eigen::MatrixXd solve_ldlt_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.ldlt().solve(b);
}

Eigen::VectorXd solve_lu(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::VectorXcd solve_lu(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXd solve_lu_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXcd solve_lu_columns(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a) {
  return a.partialPivLu().inverse();
}

Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& a) {
  return a.partialPivLu().inverse();
}

std::complex<double> determinant(const Eigen::MatrixXcd& a) {
  return a.partialPivLu().determinant();
}

namespace {

void multiply(const double* a, const double* b, double* out, int n) {
  for (int i = 0; i < n; ++i) {
    double* row = out + i * n;
    std::fill(row, row + n, 0.0);
    for (int k = 0; k < n; ++k) {
      const double f = a[i * n + k];
      if (f == 0.0) continue;
      const double* other = b + k * n;
      for (int j = 0; j < n; ++j) row[j] += f * other[j];
    }
  }
}

}  // namespace

void matrix_exponential(double* m, int n, std::vector<double>& work) {
  const std::size_t size = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  work.resize(2 * size);
  double* sum = work.data();
  double* next = work.data() + size;
  double norm = 0.0;
  for (int i = 0; i < n; ++i) {
    double row = 0.0;
    for (int j = 0; j < n; ++j) row += std::abs(m[i * n + j]);
    norm = std::max(norm, row);
  }
  const int squarings = norm > 0.5 ? whole_number(std::ceil(std::log2(norm / 0.5)), 0, 1100) : 0;
  const double scale = std::ldexp(1.0, -squarings);
  for (std::size_t i = 0; i < size; ++i) m[i] *= scale;
  // Horner: I + M (I + M/2 (I + M/3 (...))); 0.5^15/15! is below 3e-17.
  constexpr int kTerms = 15;
  std::fill(sum, sum + size, 0.0);
  for (int i = 0; i < n; ++i) sum[i * n + i] = 1.0;
  for (int k = kTerms; k >= 1; --k) {
    multiply(m, sum, next, n);
    for (std::size_t i = 0; i < size; ++i) sum[i] = next[i] / k;
    for (int i = 0; i < n; ++i) sum[i * n + i] += 1.0;
  }
  for (int s = 0; s < squarings; ++s) {
    multiply(sum, sum, next, n);
    std::swap(sum, next);
  }
  std::copy(sum, sum + size, m);
}

Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& m) {
  // Column-major data are the transpose's rows, and exp(Mᵀ) = exp(M)ᵀ.
  Eigen::MatrixXd out = m;
  std::vector<double> work;
  matrix_exponential(out.data(), static_cast<int>(m.rows()), work);
  return out;
}

}  // namespace bodesmith
