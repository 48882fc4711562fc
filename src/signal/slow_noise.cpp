#include "signal/slow_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace bodesmith {
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
  const bool empty = std::any_of(bands.begin(), bands.end(), [](const Band& b) { return !(b.power > 0.0); });
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
