#include "numeric/linear_algebra/dense.hpp"

// Dense linear algebra that is compiled once: what each function promises, by multiplying back.

#include <gtest/gtest.h>

#include <cmath>

#include "numeric/random.hpp"
#include "numeric/random_matrix.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

MatrixXd one(Eigen::Index n) {
  return MatrixXd::Identity(n, n);
}

/// Neither symmetric nor normal, with a pair of complex eigenvalues.
MatrixXd plain_matrix() {
  MatrixXd a(3, 3);
  a << 1.0, 4.0, -2.0, -3.0, 2.0, 0.5, 0.25, -1.0, 3.0;
  return a;
}

TEST(Dense, InversesAndDeterminants) {
  const MatrixXd a = plain_matrix();
  EXPECT_LT(apart(times(a, inverse(a)), one(3)), 1e-14);
  const MatrixXcd c = a.cast<Complex>() * Complex(0.0, 2.0);
  EXPECT_LT(apart(product(c, inverse(c)), MatrixXcd(one(3).cast<Complex>())), 1e-14);
  // det(2j A) = (2j)^3 det A, and det A = 38.0 by hand.
  EXPECT_NEAR(std::abs(determinant(c) - Complex(0.0, -8.0) * 38.0), 0.0, 1e-12);
}

TEST(Dense, SquareSystemsOfAnyKindAreSolved) {
  const MatrixXd a = plain_matrix();
  const MatrixXd b = a.transpose();
  const VectorXd column = b.col(1);
  EXPECT_LT(apart(times(a, solve_lu_columns(a, b)), b), 1e-13);
  EXPECT_LT(apart(times(a, MatrixXd(solve_lu(a, column))), MatrixXd(column)), 1e-13);
  const MatrixXcd wanted = b.cast<Complex>();
  const MatrixXcd c = Complex(0.0, 1.0) * wanted + a.cast<Complex>();
  EXPECT_LT(apart(product(c, solve_lu_columns(c, wanted)), wanted), 1e-13);
  EXPECT_LT(apart(product(c, MatrixXcd(solve_lu(c, VectorXcd(wanted.col(1))))), MatrixXcd(wanted.col(1))),
            1e-13);
  const SquareSvd svd = square_svd(a);
  EXPECT_LT(apart(times(times(svd.u, MatrixXd(svd.values.asDiagonal())), MatrixXd(svd.v.transpose())), a),
            1e-13);
  EXPECT_LT(apart(gram(svd.u), one(3)), 1e-14);
  EXPECT_GE(svd.values(0), svd.values(1));
}

TEST(Dense, EveryColumnIsSolvedLikeOne) {
  const MatrixXd a = gram(plain_matrix());
  const MatrixXd b = plain_matrix();
  const MatrixXd x = solve_ldlt_columns(a, b);
  EXPECT_LT(apart(times(a, x), b), 1e-12);
  EXPECT_LT(apart(MatrixXd(x.col(1)), MatrixXd(solve_ldlt(a, b.col(1)))), 1e-12);
}

TEST(Dense, EigenvectorsAreWhatTheMatrixOnlyStretches) {
  const MatrixXd a = plain_matrix();
  const auto modes = eigen_system(a);
  ASSERT_TRUE(modes.has_value());
  EXPECT_GT(modes->values.imag().cwiseAbs().maxCoeff(), 1.0);
  const MatrixXcd stretched = modes->vectors * modes->values.asDiagonal();
  EXPECT_LT(apart(product(a.cast<Complex>(), modes->vectors), stretched), 1e-13);
  EXPECT_NEAR((eigenvalues(a).sum() - modes->values.sum()).real(), 0.0, 1e-13);
}

TEST(Dense, SingularValuesOfTallAndWideMatrices) {
  // Columns at right angles of lengths 5, 2 and 1e-9, turned.
  MatrixXd tall = MatrixXd::Zero(6, 3);
  tall.col(0) << 3.0, 4.0, 0.0, 0.0, 0.0, 0.0;
  tall.col(1) << -1.6, 1.2, 0.0, 0.0, 0.0, 0.0;
  tall(4, 2) = 1e-9;
  MatrixXd turn(3, 3);
  turn << 0.6, 0.0, 0.8, 0.0, 1.0, 0.0, -0.8, 0.0, 0.6;
  const MatrixXd turned = times(tall, turn);
  for (const MatrixXd& a : {turned, MatrixXd(turned.transpose())}) {
    const VectorXd values = singular_values(a);
    ASSERT_EQ(values.size(), 3);
    EXPECT_NEAR(values(0), 5.0, 1e-14);
    EXPECT_NEAR(values(1), 2.0, 1e-14);
    EXPECT_NEAR(values(2), 1e-9, 1e-15);
  }
  const VectorXd v = smallest_singular_vector(turned);
  EXPECT_NEAR(v.norm(), 1.0, 1e-14);
  EXPECT_NEAR(times(turned, v).norm(), 1e-9, 1e-15);
}

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
    EXPECT_LT(apart(times(matrix_exponential(m), matrix_exponential(-m)), one(n)), 1e-11) << n;
    // exp(A)^2 = exp(2 A).
    const MatrixXd once = matrix_exponential(m);
    const MatrixXd twice = times(once, once);
    EXPECT_LT(apart(twice, matrix_exponential(2.0 * m)), 1e-12 * twice.norm()) << n;
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

TEST(Dense, OrthonormalColumnsSpanTheSameAndTheLeastNormSolves) {
  const MatrixXd a = (MatrixXd(4, 4) << 1, 2, 0, 1, -1, 3, 2, 0, 2, 0, 1, 5, 0, 1, -2, 1).finished();
  const MatrixXd q = orthonormal_columns(a);
  EXPECT_LT(apart(gram(q), one(4)), 1e-14);
  const MatrixXd r = times(MatrixXd(q.transpose()), a);  // upper
  for (Eigen::Index i = 1; i < 4; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) EXPECT_NEAR(r(i, k), 0.0, 1e-14);
  }
  const MatrixXd wide = a.topRows(2);
  const MatrixXd b = (MatrixXd(2, 1) << 3, -4).finished();
  const MatrixXd x = least_norm_columns(wide, b);
  EXPECT_LT(apart(times(wide, x), b), 1e-13);
  const MatrixXd back = wide.transpose();
  const MatrixXd s = gram(back);
  const MatrixXd turned = (MatrixXd(2, 2) << s(1, 1), -s(0, 1), -s(1, 0), s(0, 0)).finished();
  const double size = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
  EXPECT_LT(apart(size * x, times(back, times(turned, b))), 1e-13 * size);
}

}  // namespace
}  // namespace bodesmith
