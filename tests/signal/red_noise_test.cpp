#include "signal/red_noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace bodesmith;

/// Noise of unit variance, of which the share is white.
std::vector<double> noise(std::size_t n, double correlation_samples, double white_share, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double rho = 1.0 - 1.0 / correlation_samples;
  double state = normal(random);
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) {
    out.push_back(std::sqrt(1.0 - white_share) * state + std::sqrt(white_share) * normal(random));
    state = rho * state + std::sqrt(1.0 - rho * rho) * normal(random);
  }
  return out;
}

/// L of A = L L', column by column.
Eigen::MatrixXd cholesky(const Eigen::MatrixXd& a) {
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(a.rows(), a.rows());
  for (Eigen::Index j = 0; j < a.rows(); ++j) {
    root(j, j) = std::sqrt(a(j, j) - root.row(j).head(j).squaredNorm());
    for (Eigen::Index i = j + 1; i < a.rows(); ++i)
      root(i, j) = (a(i, j) - root.row(i).head(j).dot(root.row(j).head(j))) / root(j, j);
  }
  return root;
}

/// x of L x = y.
Eigen::VectorXd forward_substituted(const Eigen::MatrixXd& root, const std::vector<double>& y) {
  Eigen::VectorXd x(root.rows());
  for (Eigen::Index i = 0; i < root.rows(); ++i)
    x(i) = (y[static_cast<std::size_t>(i)] - root.row(i).head(i).dot(x.head(i))) / root(i, i);
  return x;
}

/// By the covariance matrix of all samples, the most likely size.
double dense_log_likelihood(const std::vector<double>& y, const RedNoise& by) {
  const auto n = static_cast<Eigen::Index>(y.size());
  const double rho = 1.0 - 1.0 / by.correlation_samples;
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      covariance(i, j) = (1.0 - by.white_share) * std::pow(rho, static_cast<double>(std::abs(i - j))) +
                         (i == j ? by.white_share : 0.0);
    }
  }
  const Eigen::MatrixXd root = cholesky(covariance);
  const double size = forward_substituted(root, y).squaredNorm() / static_cast<double>(n);
  const double determinant = 2.0 * root.diagonal().array().log().sum();
  return -0.5 * (static_cast<double>(n) * (std::log(2.0 * std::numbers::pi * size) + 1.0) + determinant);
}

TEST(RedNoise, HasTheLikelihoodOfItsCovariance) {
  for (const double white : {0.05, 0.5, 0.9}) {
    const auto y = noise(200, 15.0, white, 7);
    const RedNoise found = most_likely_red_noise({y});
    EXPECT_NEAR(found.log_likelihood, dense_log_likelihood(y, found), 1e-6 * std::abs(found.log_likelihood));
    // And none around it is likelier.
    for (const double factor : {0.7, 1.4}) {
      RedNoise other = found;
      other.correlation_samples = std::max(1.0, factor * found.correlation_samples);
      EXPECT_LE(dense_log_likelihood(y, other), found.log_likelihood + 0.01);
      other = found;
      const double odds = factor * found.white_share / (1.0 - found.white_share);
      other.white_share = odds / (1.0 + odds);
      EXPECT_LE(dense_log_likelihood(y, other), found.log_likelihood + 0.01);
    }
  }
}

// By the triangular root of its covariance matrix: the same numbers, each of unit variance and by itself.
TEST(RedNoise, IsWhitenedByTheRootOfItsCovariance) {
  const RedNoise by{.correlation_samples = 12.0, .white_share = 0.3, .driving_variance = 0.04};
  std::vector<double> y = noise(60, 9.0, 0.5, 5);
  const auto n = static_cast<Eigen::Index>(y.size());
  const double rho = 1.0 - 1.0 / by.correlation_samples;
  const double red = by.driving_variance / (1.0 - rho * rho);
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      covariance(i, j) = red * std::pow(rho, static_cast<double>(std::abs(i - j))) +
                         (i == j ? red * by.white_share / (1.0 - by.white_share) : 0.0);
  }
  const Eigen::VectorXd wanted = forward_substituted(cholesky(covariance), y);
  whiten(y, by);
  for (Eigen::Index i = 0; i < n; ++i) EXPECT_NEAR(y[static_cast<std::size_t>(i)], wanted(i), 1e-9);
}

TEST(RedNoise, IsFoundAgain) {
  const RedNoise found = most_likely_red_noise({noise(20000, 50.0, 0.3, 3)});
  EXPECT_NEAR(found.correlation_samples, 50.0, 10.0);
  EXPECT_NEAR(found.white_share, 0.3, 0.05);
}

TEST(RedNoise, SeriesThatAreApartCountEach) {
  const auto a = noise(4000, 30.0, 0.2, 1);
  const auto b = noise(4000, 30.0, 0.2, 2);
  const RedNoise together = most_likely_red_noise({a, b});
  EXPECT_NEAR(together.correlation_samples, 30.0, 8.0);
  EXPECT_LE(together.log_likelihood,
            most_likely_red_noise({a}).log_likelihood + most_likely_red_noise({b}).log_likelihood + 1e-3);
}

TEST(RedNoise, OfNothingIsLikelyBeyondMeasure) {
  const std::vector<double> zeros(100, 0.0);
  EXPECT_TRUE(std::isinf(most_likely_red_noise({zeros}).log_likelihood));
}

}  // namespace
