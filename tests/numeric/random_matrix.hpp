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

}  // namespace bodesmith
