#include "signal/red_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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

namespace {

constexpr double kWider = 1.25;
/// The window spreads the mean over the lowest bins.
constexpr std::size_t kFirstBin = 2;
constexpr std::size_t kMinBands = 12;
/// Neighbouring bins share the window's lobe: so many count as one.
constexpr double kAlike = 1.5;
constexpr std::array kSlopes = {1.0, 1.5, 2.0};
constexpr int kCorners = 30;
/// Corners f0 from here, in bins, to this part of the highest one.
constexpr double kLowestCorner = 0.5;
constexpr double kHighestCorner = 0.33;
constexpr int kIterations = 25;
/// Free values of S(f).
constexpr double kValues = 3.0;

struct Band {
  double bin = 0.0;    ///< middle
  double power = 0.0;  ///< mean
  double count = 0.0;
};

std::vector<Band> bands_of(std::span<const double> power) {
  std::vector<Band> bands;
  for (std::size_t k = kFirstBin; k < power.size();) {
    const auto wide = static_cast<std::size_t>(kWider * static_cast<double>(k));
    const std::size_t end = std::min(power.size(), std::max(k + 1, wide));
    const auto count = static_cast<double>(end - k);
    const double sum = std::accumulate(power.begin() + static_cast<std::ptrdiff_t>(k),
                                       power.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    bands.push_back({std::sqrt(static_cast<double>(k) * static_cast<double>(end - 1)), sum / count, count});
    k = end;
  }
  return bands;
}

/// Most likely w and a for one shape 1/(1 + (f/f0)^p), by scoring: weighted least squares with the weights of the last S.
struct Levels {
  double white = 0.0;
  double slow = 0.0;
  double at(double shape) const { return white + slow * shape; }
};
Levels most_likely_levels(const std::vector<Band>& bands, const std::vector<double>& shape) {
  Levels now{bands.back().power, bands.front().power};
  for (int i = 0; i < kIterations; ++i) {
    double ww = 0.0, ws = 0.0, ss = 0.0, pw = 0.0, ps = 0.0;
    for (std::size_t b = 0; b < bands.size(); ++b) {
      const double level = now.at(shape[b]);
      const double weight = bands[b].count / (level * level);
      ww += weight;
      ws += weight * shape[b];
      ss += weight * shape[b] * shape[b];
      pw += weight * bands[b].power;
      ps += weight * shape[b] * bands[b].power;
    }
    const double determinant = ww * ss - ws * ws;
    if (!(determinant > 0.0)) break;
    Levels next{(pw * ss - ps * ws) / determinant, (ps * ww - pw * ws) / determinant};
    if (next.white < 0.0) next = {0.0, ps / ss};
    if (next.slow < 0.0) next = {pw / ww, 0.0};
    // Half of the way: where few bands tell the one from the other, whole steps turn in circles.
    now = {0.5 * (now.white + next.white), 0.5 * (now.slow + next.slow)};
  }
  return now;
}

struct Agreement {
  double cost = std::numeric_limits<double>::infinity();  ///< -log likelihood
  double deviance = 0.0;
};
Agreement agreement(const std::vector<Band>& bands, const std::vector<double>& shape) {
  const Levels levels = most_likely_levels(bands, shape);
  Agreement out{0.0, 0.0};
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const double level = levels.at(shape[b]);
    const double ratio = bands[b].power / level;
    out.cost += bands[b].count * (std::log(level) + ratio);
    out.deviance += 2.0 / kAlike * bands[b].count * (ratio - 1.0 - std::log(ratio));
  }
  return out;
}

}  // namespace

double deviations_from_slow_noise(std::span<const double> power) {
  const auto bands = bands_of(power);
  const bool empty = std::ranges::any_of(bands, [](const Band& b) { return !(b.power > 0.0); });
  if (bands.size() < kMinBands || empty) return 0.0;
  Agreement best;
  const double span = kHighestCorner * bands.back().bin / kLowestCorner;
  for (const double slope : kSlopes) {
    for (int i = 0; i < kCorners; ++i) {
      const double corner = kLowestCorner * std::pow(span, static_cast<double>(i) / (kCorners - 1));
      std::vector<double> shape;
      for (const auto& band : bands) shape.push_back(1.0 / (1.0 + std::pow(band.bin / corner, slope)));
      const auto agrees = agreement(bands, shape);
      if (agrees.cost < best.cost) best = agrees;
    }
  }
  const double freedom = static_cast<double>(bands.size()) - kValues;
  return (best.deviance - freedom) / std::sqrt(2.0 * freedom);
}

}  // namespace bodesmith
