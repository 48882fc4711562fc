#include "numeric/fixed_matrix.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "random_matrix.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

TEST(FixedMatrix, ProductsAreThoseOfTheMatrix) {
  // Rows around the blocks of eight, columns of the other around those of four.
  for (const Index rows : {1, 7, 8, 9, 52}) {
    const MatrixXd a = random_matrix(rows, 97);
    const FixedMatrix fixed(a);
    EXPECT_EQ(fixed.rows(), rows);
    EXPECT_EQ(fixed.columns(), 97);
    for (Index columns = 1; columns <= 9; ++columns) {
      const MatrixXd x = random_matrix(97, columns);
      EXPECT_LT((fixed.times(x) - a * x).cwiseAbs().maxCoeff(), 1e-12) << rows << " rows, " << columns;
    }
  }
}

TEST(FixedMatrix, OfNothingIsNothing) {
  EXPECT_EQ(FixedMatrix(MatrixXd(3, 0)).times(MatrixXd(0, 2)), MatrixXd::Zero(3, 2));
  EXPECT_EQ(FixedMatrix().times(MatrixXd(0, 2)).rows(), 0);
}

TEST(FixedMatrix, AnotherLengthIsRefused) {
  EXPECT_THROW(FixedMatrix(random_matrix(5, 3)).times(MatrixXd::Zero(4, 1)), std::logic_error);
}

}  // namespace
}  // namespace bodesmith
