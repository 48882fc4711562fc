#include "signal/red_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/optimisation/minimum.hpp"

namespace bodesmith {
namespace {

using Series = std::vector<std::span<const double>>;

constexpr double kSettled = 1e-12;

/// What the Kalman filter makes of series, in units of the variance of w.
struct Filtered {
  double squares = 0.0;        ///< of the innovations, each over its variance
  double log_variances = 0.0;  ///< sum
};

void filter(std::span<const double> y, double rho, double white, Filtered& sum) {
  double state = 0.0;
  double variance = 1.0 / (1.0 - rho * rho);
  std::size_t t = 0;
  for (bool settled = false; t < y.size() && !settled; ++t) {
    const double whole = variance + white;
    const double innovation = y[t] - state;
    sum.squares += innovation * innovation / whole;
    sum.log_variances += std::log(whole);
    state = rho * (state + variance / whole * innovation);
    const double next = rho * rho * variance * white / whole + 1.0;
    settled = std::abs(next - variance) < kSettled * variance;
    variance = next;
  }
  const double whole = variance + white;
  const double gain = rho * variance / whole;
  double squares = 0.0;
  for (std::size_t k = t; k < y.size(); ++k) {
    const double innovation = y[k] - state;
    squares += innovation * innovation;
    state = rho * state + gain * innovation;
  }
  sum.squares += squares / whole;
  sum.log_variances += static_cast<double>(y.size() - t) * std::log(whole);
}

double log_likelihood(const Series& series, double rho, double white) {
  Filtered sum;
  double n = 0.0;
  for (const auto& y : series) {
    filter(y, rho, white, sum);
    n += static_cast<double>(y.size());
  }
  if (!(sum.squares > 0.0)) return std::numeric_limits<double>::infinity();
  constexpr double kLogTwoPi = 1.8378770664093454836;
  return -0.5 * (n * (std::log(sum.squares / n) + 1.0 + kLogTwoPi) + sum.log_variances);
}

/// The noise by the logarithms of its correlation and of var v over var w, which can be searched for one after the other: a
/// record tells the second whatever the first.
struct Place {
  double log_correlation = 0.0;
  double log_white = 0.0;

  double rho() const { return 1.0 - std::exp(-log_correlation); }
  double white() const { return std::exp(log_white); }
  double odds_of_white() const { return white() * (1.0 - rho() * rho()); }
};

}  // namespace

RedNoise most_likely_red_noise(const Series& series, double of_longest) {
  constexpr double kStep = 0.9;
  constexpr double kMostOdds = 9.0;
  constexpr double kTolerance = 0.02;
  constexpr int kRounds = 3;
  std::size_t longest = 0;
  for (const auto& y : series) longest = std::max(longest, y.size());
  const double longest_correlation = std::log(std::max(2.0, of_longest * static_cast<double>(longest)));
  const auto likelihood = [&](const Place& at) { return log_likelihood(series, at.rho(), at.white()); };
  Place best;
  double most = -std::numeric_limits<double>::infinity();
  for (double c = 0.0; c < longest_correlation + kStep; c += kStep) {
    for (double odds = -kMostOdds; odds <= kMostOdds; odds += 2.0 * kStep) {
      Place here{std::min(c, longest_correlation)};
      here.log_white = odds - std::log(here.odds_of_white());
      const double l = likelihood(here);
      if (l > most) {
        most = l;
        best = here;
      }
    }
  }
  for (int round = 0; round < kRounds && std::isfinite(most); ++round) {
    const double low = std::max(0.0, best.log_correlation - kStep);
    const double high = std::min(longest_correlation, best.log_correlation + kStep);
    best.log_correlation = minimum_between(low, high, kTolerance, [&](double c) {
      return -likelihood({c, best.log_white});
    });
    best.log_white = minimum_between(best.log_white - 2.0 * kStep, best.log_white + 2.0 * kStep, kTolerance,
                                     [&](double white) {
                                       return -likelihood({best.log_correlation, white});
                                     });
  }
  const double odds = best.odds_of_white();
  Filtered sum;
  double n = 0.0;
  for (const auto& y : series) {
    filter(y, best.rho(), best.white(), sum);
    n += static_cast<double>(y.size());
  }
  return {std::exp(best.log_correlation), odds / (1.0 + odds), std::max(most, likelihood(best)),
          n > 0.0 ? sum.squares / n : 0.0};
}

void whiten(std::span<double> series, const RedNoise& noise) {
  const double rho = 1.0 - 1.0 / noise.correlation_samples;
  const double white = noise.white_share / (1.0 - noise.white_share) / (1.0 - rho * rho);
  double state = 0.0;
  double variance = 1.0 / (1.0 - rho * rho);
  for (double& y : series) {
    const double whole = variance + white;
    const double innovation = y - state;
    state = rho * (state + variance / whole * innovation);
    variance = rho * rho * variance * white / whole + 1.0;
    y = innovation / std::sqrt(whole * noise.driving_variance);
  }
}

}  // namespace bodesmith
