#include "numeric/matrix_exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "numeric/random.hpp"

namespace bodesmith {
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
    EXPECT_LT((once * once - matrix_exponential(2.0 * m)).norm(), 1e-12 * (once * once).norm()) << n;
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
}  // namespace bodesmith
