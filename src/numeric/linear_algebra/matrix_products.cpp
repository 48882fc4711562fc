#include "numeric/linear_algebra/matrix_products.hpp"

#include <algorithm>
#include <stdexcept>

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

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// y = A x, four rows at a time; `rows` a multiple of four.
BODESMITH_CLONES void multiply_rows(const double* data, std::size_t rows, std::size_t blocks, const double* x,
                                    double* y) {
  const std::size_t width = 4 * blocks;
  const Four* by = four_at(x);
  for (std::size_t r = 0; r < rows; r += 4) {
    const Four* a = four_at(data + r * width);
    const Four* b = four_at(data + (r + 1) * width);
    const Four* c = four_at(data + (r + 2) * width);
    const Four* d = four_at(data + (r + 3) * width);
    Four sum_a = a[0] * by[0];
    Four sum_b = b[0] * by[0];
    Four sum_c = c[0] * by[0];
    Four sum_d = d[0] * by[0];
    for (std::size_t k = 1; k < blocks; ++k) {
      sum_a += a[k] * by[k];
      sum_b += b[k] * by[k];
      sum_c += c[k] * by[k];
      sum_d += d[k] * by[k];
    }
    y[r] = (sum_a[0] + sum_a[1]) + (sum_a[2] + sum_a[3]);
    y[r + 1] = (sum_b[0] + sum_b[1]) + (sum_b[2] + sum_b[3]);
    y[r + 2] = (sum_c[0] + sum_c[1]) + (sum_c[2] + sum_c[3]);
    y[r + 3] = (sum_d[0] + sum_d[1]) + (sum_d[2] + sum_d[3]);
  }
}

/// y = A' z, block by block of columns.
BODESMITH_CLONES void multiply_columns(const double* data, std::size_t rows, std::size_t blocks,
                                       const double* z, double* y) {
  const std::size_t width = 4 * blocks;
  for (std::size_t k = 0; k < blocks; ++k) {
    const double* at = data + 4 * k;
    Four a = {0.0, 0.0, 0.0, 0.0};
    Four b = a;
    Four c = a;
    Four d = a;
    for (std::size_t r = 0; r < rows; r += 4, at += 4 * width) {
      a += z[r] * *four_at(at);
      b += z[r + 1] * *four_at(at + width);
      c += z[r + 2] * *four_at(at + 2 * width);
      d += z[r + 3] * *four_at(at + 3 * width);
    }
    *four_at(y + 4 * k) = (a + b) + (c + d);
  }
}

/// Of A' diag(w) A the rows of block `row` in the columns of block `column` and the next one; `weighted` is diag(w) A.
BODESMITH_CLONES void gram_tile(const double* data, const double* weighted, std::size_t rows,
                                std::size_t width, std::size_t row, std::size_t column, bool two,
                                double* out) {
  Four a0 = {0.0, 0.0, 0.0, 0.0};
  Four a1 = a0, a2 = a0, a3 = a0, b0 = a0, b1 = a0, b2 = a0, b3 = a0;
  const double* left = weighted + 4 * column;
  const double* at = data + 4 * row;
  if (two) {
    for (std::size_t r = 0; r < rows; ++r, left += width, at += width) {
      const Four x = *four_at(at);
      const Four y = *four_at(at + 4);
      a0 += left[0] * x;
      b0 += left[0] * y;
      a1 += left[1] * x;
      b1 += left[1] * y;
      a2 += left[2] * x;
      b2 += left[2] * y;
      a3 += left[3] * x;
      b3 += left[3] * y;
    }
  } else {
    for (std::size_t r = 0; r < rows; ++r, left += width, at += width) {
      const Four x = *four_at(at);
      a0 += left[0] * x;
      a1 += left[1] * x;
      a2 += left[2] * x;
      a3 += left[3] * x;
    }
  }
  double* to = out + 4 * column * width + 4 * row;
  *four_at(to) = a0;
  *four_at(to + width) = a1;
  *four_at(to + 2 * width) = a2;
  *four_at(to + 3 * width) = a3;
  if (!two) return;
  *four_at(to + 4) = b0;
  *four_at(to + width + 4) = b1;
  *four_at(to + 2 * width + 4) = b2;
  *four_at(to + 3 * width + 4) = b3;
}

/// diag(w) A.
BODESMITH_CLONES void scale_rows(const double* data, std::size_t rows, std::size_t blocks, const double* w,
                                 double* out) {
  for (std::size_t r = 0; r < rows; ++r, data += 4 * blocks, out += 4 * blocks) {
    for (std::size_t k = 0; k < 4 * blocks; k += 4) *four_at(out + k) = w[r] * *four_at(data + k);
  }
}

void require_length(Index got, Index wanted) {
  if (got != wanted) throw std::logic_error("tall matrix: lengths differ");
}

std::vector<double> padded(const VectorXd& from, std::size_t size) {
  std::vector<double> out(size, 0.0);
  std::copy(from.begin(), from.end(), out.begin());
  return out;
}

}  // namespace

TallMatrix::TallMatrix(const MatrixXd& a)
    : rows_(a.rows()),
      columns_(a.cols()),
      blocks_(std::max<std::size_t>(1, (std_index(a.cols()) + 3) / 4)),
      padded_rows_(std::max<std::size_t>(1, (std_index(a.rows()) + 3) / 4) * 4),
      data_(padded_rows_ * 4 * blocks_, 0.0) {
  for (Index j = 0; j < columns_; ++j) {
    for (Index i = 0; i < rows_; ++i) data_[std_index(i) * 4 * blocks_ + std_index(j)] = a(i, j);
  }
}

VectorXd TallMatrix::times(const VectorXd& x) const {
  require_length(x.size(), columns_);
  const std::vector<double> by = padded(x, 4 * blocks_);
  VectorXd out(eigen_index(padded_rows_));
  multiply_rows(data_.data(), padded_rows_, blocks_, by.data(), out.data());
  out.conservativeResize(rows_);
  return out;
}

VectorXd TallMatrix::transpose_times(const VectorXd& z) const {
  require_length(z.size(), rows_);
  const std::vector<double> by = padded(z, padded_rows_);
  VectorXd out(eigen_index(4 * blocks_));
  multiply_columns(data_.data(), padded_rows_, blocks_, by.data(), out.data());
  out.conservativeResize(columns_);
  return out;
}

MatrixXd TallMatrix::gram(const VectorXd& w) const {
  require_length(w.size(), rows_);
  const std::size_t width = 4 * blocks_;
  const auto rows = std_index(rows_);
  std::vector<double> weighted(padded_rows_ * width);
  scale_rows(data_.data(), rows, blocks_, w.data(), weighted.data());
  MatrixXd all(eigen_index(width), eigen_index(width));
  for (std::size_t column = 0; column < blocks_; ++column) {
    for (std::size_t row = column; row < blocks_; row += 2) {
      gram_tile(data_.data(), weighted.data(), rows, width, row, column, row + 1 < blocks_, all.data());
    }
  }
  MatrixXd out = all.topLeftCorner(columns_, columns_);
  for (Index j = 0; j < columns_; ++j) {
    for (Index i = 0; i < j; ++i) out(i, j) = out(j, i);
  }
  return out;
}

}  // namespace bodesmith
