#include "numeric/matrix_exponential.hpp"

#include <algorithm>
#include <cmath>

#include "base/whole_number.hpp"

namespace bodesmith {
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
