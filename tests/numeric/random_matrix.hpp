#pragma once

#include <Eigen/Core>

#include "numeric/index.hpp"
#include "numeric/random.hpp"

namespace bodesmith {

/// Normal numbers, the same for the same size.
inline Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns) {
  Random random(std_index(100 * rows + columns));
  Eigen::MatrixXd out(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) out(i, j) = random.normal();
  return out;
}

/// Greatest |a - b|: compiled once, where each difference of two expressions would be for itself.
inline double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.size() == 0 && b.size() == 0 ? 0.0 : (a - b).cwiseAbs().maxCoeff();
}
inline double apart(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}
/// For matrices of a few rows: without the blocks and packets of great products.
inline Eigen::MatrixXcd product(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return a.lazyProduct(b);
}

}  // namespace bodesmith
