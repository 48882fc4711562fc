#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace bodesmith {

/// LU decomposition with partial pivoting of a small dense complex matrix.
class ComplexLu {
 public:
  using Complex = std::complex<double>;

  /// `rows` holds n rows of n, row after row.
  ComplexLu(std::vector<Complex> rows, std::size_t n);

  /// A pivot is zero (or not finite): there is no solution.
  bool is_singular() const { return singular_; }
  Complex determinant() const { return determinant_; }
  /// x of A x = b. Only when not singular.
  std::vector<Complex> solve(std::vector<Complex> b) const;

 private:
  Complex& at(std::size_t row, std::size_t column) { return rows_[row * n_ + column]; }
  const Complex& at(std::size_t row, std::size_t column) const { return rows_[row * n_ + column]; }

  std::vector<Complex> rows_;
  std::size_t n_;
  std::vector<std::size_t> order_;  ///< row i of L and U was row order_[i]
  Complex determinant_ = 1.0;
  bool singular_ = false;
};

}  // namespace bodesmith
