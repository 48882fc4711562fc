#include "numeric/linear_algebra/matrix_products.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "numeric/linear_algebra/dense.hpp"
#include "numeric/random_matrix.hpp"

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
      EXPECT_LT(apart(fixed.times(x), times(a, x)), 1e-12) << rows << " rows, " << columns;
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

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Sizes around the blocks of four, and those of a fit.
const std::pair<Index, Index> kSizes[] = {{1, 1}, {3, 5}, {4, 4}, {5, 3}, {7, 8}, {160, 17}, {403, 18}};

TEST(TallMatrix, ProductsAreThoseOfTheMatrix) {
  for (const auto& [rows, columns] : kSizes) {
    const MatrixXd a = random_matrix(rows, columns);
    const TallMatrix tall(a);
    const VectorXd x = random_matrix(columns, 1);
    const VectorXd z = random_matrix(rows, 1);
    EXPECT_LT(apart(MatrixXd(tall.times(x)), MatrixXd(times(a, x))), 1e-13) << rows << " x " << columns;
    EXPECT_LT(apart(MatrixXd(tall.transpose_times(z)), MatrixXd(transpose_times(a, z))), 1e-12)
        << rows << " x " << columns;
  }
}

TEST(TallMatrix, GramIsSymmetricAndThatOfTheWeightedRows) {
  for (const auto& [rows, columns] : kSizes) {
    const MatrixXd a = random_matrix(rows, columns);
    const VectorXd w = random_matrix(rows, 1).cwiseAbs();
    const MatrixXd got = TallMatrix(a).gram(w);
    ASSERT_EQ(got.rows(), columns);
    EXPECT_TRUE(got == got.transpose());
    EXPECT_LT(apart(got, times(MatrixXd(a.transpose()), MatrixXd(w.asDiagonal() * a))), 1e-11)
        << rows << " x " << columns;
  }
}

TEST(TallMatrix, OfNoRowsIsZero) {
  const TallMatrix a(MatrixXd(0, 9));
  EXPECT_EQ(a.times(VectorXd::Ones(9)).size(), 0);
  EXPECT_EQ(a.transpose_times(VectorXd(0)), VectorXd::Zero(9));
  EXPECT_EQ(a.gram(VectorXd(0)), MatrixXd::Zero(9, 9));
}

TEST(TallMatrix, AnotherLengthIsRefused) {
  const TallMatrix a(random_matrix(5, 3));
  EXPECT_THROW(a.times(VectorXd::Zero(4)), std::logic_error);
  EXPECT_THROW(a.transpose_times(VectorXd::Zero(3)), std::logic_error);
  EXPECT_THROW(a.gram(VectorXd::Zero(3)), std::logic_error);
}

}  // namespace

}  // namespace bodesmith
