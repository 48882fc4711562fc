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

}  // namespace bodesmith
