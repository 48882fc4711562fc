#include "numeric/linear_algebra/dense.hpp"

// Dense linear algebra that is compiled once: what each function promises, by multiplying back.

#include <gtest/gtest.h>

#include <cmath>

#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// Neither symmetric nor normal, with a pair of complex eigenvalues.
Eigen::MatrixXd plain_matrix() {
  Eigen::MatrixXd a(3, 3);
  a << 1.0, 4.0, -2.0, -3.0, 2.0, 0.5, 0.25, -1.0, 3.0;
  return a;
}

TEST(Dense, InversesAndDeterminants) {
  const Eigen::MatrixXd a = plain_matrix();
  EXPECT_LT((a * inverse(a) - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-14);
  const Eigen::MatrixXcd c = a.cast<Complex>() * Complex(0.0, 2.0);
  EXPECT_LT((c * inverse(c) - Eigen::MatrixXcd::Identity(3, 3)).norm(), 1e-14);
  // det(2j A) = (2j)^3 det A, and det A = 38.0 by hand.
  EXPECT_NEAR(std::abs(determinant(c) - Complex(0.0, -8.0) * 38.0), 0.0, 1e-12);
}

TEST(Dense, SquareSystemsOfAnyKindAreSolved) {
  const Eigen::MatrixXd a = plain_matrix();
  const Eigen::MatrixXd b = a.transpose();
  EXPECT_LT((a * solve_lu_columns(a, b) - b).norm(), 1e-13);
  EXPECT_LT((a * solve_lu(a, Eigen::VectorXd(b.col(1))) - b.col(1)).norm(), 1e-13);
  const Eigen::MatrixXcd c = a.cast<Complex>() + Complex(0.0, 1.0) * b;
  EXPECT_LT((c * solve_lu_columns(c, Eigen::MatrixXcd(b)) - b).norm(), 1e-13);
  EXPECT_LT((c * solve_lu(c, Eigen::VectorXcd(b.col(1))) - b.col(1)).norm(), 1e-13);
  const SquareSvd svd = square_svd(a);
  EXPECT_LT((svd.u * svd.values.asDiagonal() * svd.v.transpose() - a).norm(), 1e-13);
  EXPECT_LT((svd.u.transpose() * svd.u - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-14);
  EXPECT_GE(svd.values(0), svd.values(1));
}

TEST(Dense, EveryColumnIsSolvedLikeOne) {
  const Eigen::MatrixXd a = gram(plain_matrix());
  const Eigen::MatrixXd b = plain_matrix();
  const Eigen::MatrixXd x = solve_ldlt_columns(a, b);
  EXPECT_LT((a * x - b).norm(), 1e-12);
  EXPECT_LT((x.col(1) - solve_ldlt(a, b.col(1))).norm(), 1e-12);
}

TEST(Dense, EigenvectorsAreWhatTheMatrixOnlyStretches) {
  const Eigen::MatrixXd a = plain_matrix();
  const auto modes = eigen_system(a);
  ASSERT_TRUE(modes.has_value());
  EXPECT_GT(modes->values.imag().cwiseAbs().maxCoeff(), 1.0);
  const Eigen::MatrixXcd stretched = modes->vectors * modes->values.asDiagonal();
  EXPECT_LT((a.cast<Complex>() * modes->vectors - stretched).norm(), 1e-13);
  EXPECT_NEAR((eigenvalues(a).sum() - modes->values.sum()).real(), 0.0, 1e-13);
}

TEST(Dense, SingularValuesOfTallAndWideMatrices) {
  // Columns at right angles of lengths 5, 2 and 1e-9, turned.
  Eigen::MatrixXd tall = Eigen::MatrixXd::Zero(6, 3);
  tall.col(0) << 3.0, 4.0, 0.0, 0.0, 0.0, 0.0;
  tall.col(1) << -1.6, 1.2, 0.0, 0.0, 0.0, 0.0;
  tall(4, 2) = 1e-9;
  Eigen::Matrix3d turn;
  turn << 0.6, 0.0, 0.8, 0.0, 1.0, 0.0, -0.8, 0.0, 0.6;
  const Eigen::MatrixXd turned = tall.lazyProduct(turn);
  for (const Eigen::MatrixXd& a : {turned, Eigen::MatrixXd(turned.transpose())}) {
    const Eigen::VectorXd values = singular_values(a);
    ASSERT_EQ(values.size(), 3);
    EXPECT_NEAR(values(0), 5.0, 1e-14);
    EXPECT_NEAR(values(1), 2.0, 1e-14);
    EXPECT_NEAR(values(2), 1e-9, 1e-15);
  }
  const Eigen::VectorXd v = smallest_singular_vector(turned);
  EXPECT_NEAR(v.norm(), 1.0, 1e-14);
  EXPECT_NEAR((turned * v).norm(), 1e-9, 1e-15);
}

}  // namespace

namespace {

using Eigen::MatrixXd;

TEST(MatrixExponential, ARotationAndADecayHaveTheirClosedForms) {
  for (const double t : {1e-9, 0.3, 4.0, 30.0}) {
    MatrixXd turn(2, 2);
    turn << 0.0, t, -t, 0.0;
    const MatrixXd got = matrix_exponential(turn);
    EXPECT_NEAR(got(0, 0), std::cos(t), 1e-13 * (1.0 + t));
    EXPECT_NEAR(got(0, 1), std::sin(t), 1e-13 * (1.0 + t));
    EXPECT_NEAR(got(1, 0), -std::sin(t), 1e-13 * (1.0 + t));
    MatrixXd jordan(2, 2);
    jordan << -t, t, 0.0, -t;
    const MatrixXd decay = matrix_exponential(jordan);
    EXPECT_NEAR(decay(0, 1), t * std::exp(-t), 1e-14 * (1.0 + t));
    EXPECT_EQ(decay(1, 0), 0.0);
  }
}

TEST(MatrixExponential, ForwardAndBackAreTheIdentity) {
  Random random(3);
  for (Eigen::Index n = 1; n <= 8; ++n) {
    MatrixXd m(n, n);
    for (double& v : m.reshaped()) v = random.normal();
    const MatrixXd product = matrix_exponential(m) * matrix_exponential(-m);
    EXPECT_LT((product - MatrixXd::Identity(n, n)).norm(), 1e-11) << n;
    // exp(A)^2 = exp(2 A).
    const MatrixXd once = matrix_exponential(m);
    const Eigen::MatrixXd twice = once.lazyProduct(once);
    EXPECT_LT((twice - matrix_exponential(2.0 * m)).norm(), 1e-12 * twice.norm()) << n;
  }
}

TEST(MatrixExponential, TheRowMajorFormIsTheSame) {
  std::vector<double> m = {0.1, 0.7, -0.3, 0.2}, work;
  MatrixXd same(2, 2);
  same << 0.1, 0.7, -0.3, 0.2;
  const MatrixXd wanted = matrix_exponential(same);
  matrix_exponential(m.data(), 2, work);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) EXPECT_NEAR(m[static_cast<std::size_t>(2 * i + j)], wanted(i, j), 1e-15);
}

}  // namespace

TEST(Dense, OrthonormalColumnsSpanTheSameAndTheLeastNormSolves) {
  const Eigen::MatrixXd a =
      (Eigen::MatrixXd(4, 4) << 1, 2, 0, 1, -1, 3, 2, 0, 2, 0, 1, 5, 0, 1, -2, 1).finished();
  const Eigen::MatrixXd q = orthonormal_columns(a);
  EXPECT_LT((q.transpose().lazyProduct(q) - Eigen::MatrixXd::Identity(4, 4)).norm(), 1e-14);
  const Eigen::MatrixXd r = q.transpose().lazyProduct(a);  // upper
  for (Eigen::Index i = 1; i < 4; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) EXPECT_NEAR(r(i, k), 0.0, 1e-14);
  }
  const Eigen::MatrixXd wide = a.topRows(2);
  const Eigen::MatrixXd b = (Eigen::MatrixXd(2, 1) << 3, -4).finished();
  const Eigen::MatrixXd x = least_norm_columns(wide, b);
  EXPECT_LT((wide.lazyProduct(x) - b).norm(), 1e-13);
  const Eigen::Matrix2d s = wide.lazyProduct(wide.transpose());
  const Eigen::Matrix2d turned = (Eigen::Matrix2d() << s(1, 1), -s(0, 1), -s(1, 0), s(0, 0)).finished();
  const Eigen::MatrixXd least =
      wide.transpose().lazyProduct(turned.lazyProduct(b)) / (s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0));
  EXPECT_LT((x - least).norm(), 1e-13);
}

}  // namespace bodesmith
