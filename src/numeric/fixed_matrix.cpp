#include "numeric/fixed_matrix.hpp"

#include <stdexcept>

#include "numeric/clones.hpp"
#include "numeric/four.hpp"
#include "numeric/index.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t kRows = 8;

/// Eight rows of A x: `a` column by column, `kColumns` columns of x and y, `depth` and `height` numbers apart.
template <std::size_t kColumns>
[[gnu::always_inline]] inline void multiply_tile(const double* a, std::size_t depth, const double* x,
                                                 double* y, std::size_t height) {
  Four upper[kColumns], lower[kColumns];
#pragma GCC unroll 4
  for (std::size_t j = 0; j < kColumns; ++j) upper[j] = lower[j] = Four{0.0, 0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < depth; ++k, a += kRows) {
    const Four first = *four_at(a), second = *four_at(a + 4);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < kColumns; ++j) {
      const double by = x[j * depth + k];
      upper[j] += first * by;
      lower[j] += second * by;
    }
  }
#pragma GCC unroll 4
  for (std::size_t j = 0; j < kColumns; ++j) {
    *four_at(y + j * height) = upper[j];
    *four_at(y + j * height + 4) = lower[j];
  }
}

/// y = A x; `height` a multiple of eight.
BODESMITH_CLONES void multiply(const double* a, std::size_t height, std::size_t depth, const double* x,
                               std::size_t columns, double* y) {
  for (std::size_t r = 0; r < height; r += kRows, a += kRows * depth) {
    std::size_t j = 0;
    for (; j + 4 <= columns; j += 4) multiply_tile<4>(a, depth, x + j * depth, y + j * height + r, height);
    const double* rest = x + j * depth;
    double* to = y + j * height + r;
    if (columns - j == 3) multiply_tile<3>(a, depth, rest, to, height);
    if (columns - j == 2) multiply_tile<2>(a, depth, rest, to, height);
    if (columns - j == 1) multiply_tile<1>(a, depth, rest, to, height);
  }
}

}  // namespace

FixedMatrix::FixedMatrix(const MatrixXd& a)
    : rows_(a.rows()),
      columns_(a.cols()),
      data_((std_index(rows_) + kRows - 1) / kRows * kRows * std_index(columns_), 0.0) {
  const std::size_t depth = std_index(columns_);
  for (std::size_t k = 0; k < depth; ++k) {
    for (std::size_t i = 0; i < std_index(rows_); ++i)
      data_[i / kRows * kRows * depth + k * kRows + i % kRows] = a(eigen_index(i), eigen_index(k));
  }
}

MatrixXd FixedMatrix::times(const MatrixXd& x) const {
  if (x.rows() != columns_) throw std::logic_error("fixed matrix: lengths differ");
  const std::size_t height = (std_index(rows_) + kRows - 1) / kRows * kRows;
  MatrixXd out(eigen_index(height), x.cols());
  multiply(data_.data(), height, std_index(columns_), x.data(), std_index(x.cols()), out.data());
  return out.topRows(rows_);
}

}  // namespace bodesmith
