#include "signal/red_noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "signal/periodogram.hpp"

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

namespace {

constexpr int kSamples = 2000;

std::vector<double> white(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> v;
  for (int i = 0; i < kSamples; ++i) v.push_back(normal(random));
  return v;
}

/// White noise of a third of its size on top.
std::vector<double> red(double correlation_samples, unsigned seed) {
  const double memory = std::exp(-1.0 / correlation_samples);
  auto v = white(seed);
  const auto top = white(seed + 1000);
  double x = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    x = memory * x + std::sqrt(1.0 - memory * memory) * v[i];
    v[i] = x + 0.3 * top[i];
  }
  return v;
}

double deviations(const std::vector<double>& v) {
  return bodesmith::deviations_from_slow_noise(bodesmith::periodogram(v, 1e-3).power);
}

TEST(SlowNoise, WhiteAndRedNoiseAreNearIt) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    EXPECT_LT(deviations(white(seed)), 5.0) << seed;
    for (double correlation : {5.0, 20.0, 120.0, 1000.0})
      EXPECT_LT(deviations(red(correlation, seed)), 5.0) << seed << " " << correlation;
  }
}

// 1/f: a lag in each octave.
TEST(SlowNoise, SoIsNoiseOfOneOverF) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<double> sum = white(seed + 500);
    for (double correlation = 2.0; correlation < 2000.0; correlation *= 2.0) {
      const double memory = std::exp(-1.0 / correlation);
      double x = 0.0;
      const auto drive = white(seed + 1000 + static_cast<unsigned>(correlation));
      for (std::size_t i = 0; i < sum.size(); ++i) {
        x = memory * x + std::sqrt(1.0 - memory * memory) * drive[i];
        sum[i] += 2.0 * x;
      }
    }
    EXPECT_LT(deviations(sum), 5.0) << seed;
  }
}

TEST(SlowNoise, ABandWithASteepEdgeAndALineAreFarFromIt) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto band = white(seed);
    auto line = white(seed);
    for (std::size_t i = 0; i < band.size(); ++i) {
      const double t = static_cast<double>(i) / kSamples;
      band[i] += 2.0 * std::sin(2.0 * std::numbers::pi * (5.0 + 40.0 * t) * t);  // sweeps to bin 85
      line[i] += 0.7 * std::sin(2.0 * std::numbers::pi * 150.0 * t);
    }
    EXPECT_GT(deviations(band), 8.0) << seed;
    EXPECT_GT(deviations(line), 8.0) << seed;
  }
}

// A deviance of 0 with n bands and three free values lies (n - 3)/sqrt(2 (n - 3)) below what chance leaves.
TEST(SlowNoise, ASpectrumThatAgreesToTheLastDigitIsBelowChance) {
  constexpr std::size_t kBins = 2000;
  int bands = 0;
  for (std::size_t k = 2; k < kBins; ++bands) k = std::min(kBins, std::max(k + 1, k * 5 / 4));
  const double freedom = bands - 3.0;
  EXPECT_NEAR(bodesmith::deviations_from_slow_noise(std::vector<double>(kBins, 7.0)),
              -std::sqrt(freedom / 2.0), 1e-6);
}

TEST(SlowNoise, OfNothingIsNothingSaid) {
  EXPECT_EQ(bodesmith::deviations_from_slow_noise({}), 0.0);
  EXPECT_EQ(deviations(std::vector<double>(kSamples, 0.0)), 0.0);
}

}  // namespace
