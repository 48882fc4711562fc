#pragma once

#include <Eigen/Core>
#include <vector>

namespace bodesmith {

/// A matrix that many others of few columns are multiplied by, with vectors as wide as the processor has. The same sums in the
/// same order on every processor.
class FixedMatrix {
 public:
  FixedMatrix() = default;
  explicit FixedMatrix(const Eigen::MatrixXd& a);

  Eigen::Index rows() const { return rows_; }
  Eigen::Index columns() const { return columns_; }
  /// A x.
  Eigen::MatrixXd times(const Eigen::MatrixXd& x) const;

 private:
  Eigen::Index rows_ = 0;
  Eigen::Index columns_ = 0;
  std::vector<double>
      data_;  ///< eight rows after eight, column by column, the last ones filled up with zeros
};

/// A matrix of many rows and few columns (tens), kept row by row: its products with vectors and its Gram matrix with weights,
/// with vectors as wide as the processor has. The same sums in the same order on every processor.
class TallMatrix {
 public:
  explicit TallMatrix(const Eigen::MatrixXd& a);

  Eigen::Index rows() const { return rows_; }
  Eigen::Index columns() const { return columns_; }
  /// A x.
  Eigen::VectorXd times(const Eigen::VectorXd& x) const;
  /// A' z.
  Eigen::VectorXd transpose_times(const Eigen::VectorXd& z) const;
  /// A' diag(w) A, both triangles.
  Eigen::MatrixXd gram(const Eigen::VectorXd& w) const;

 private:
  Eigen::Index rows_;
  Eigen::Index columns_;
  std::size_t blocks_;        ///< of four columns, the last one filled up with zeros
  std::size_t padded_rows_;   ///< a multiple of four above 0, filled up with zeros
  std::vector<double> data_;  ///< padded_rows_ x 4 blocks_
};

}  // namespace bodesmith
