#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "gap/evidence/noise_floor.hpp"
#include "gap/signs/signs.hpp"
#include "signal/periodogram.hpp"
#include "signal/red_noise.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Densities of the three parts of the spectrum from an eighth of the sampling rate up differ by this factor at the most
/// where the noise is white. Of coloured noise x_i = a x_(i-1) + w_i they differ by 1.9 with a = 0.3 and by more with a
/// larger a.
constexpr double kFlat = 1.5;
/// Deviations beyond those of noise that forgets itself over the floor: what a missing effect leaves keeps to the drive's band.
constexpr double kNoSlowNoise = 5.5;

/// The mean of exponentially distributed numbers by their median: lines do not count.
double density(std::span<const double> power) {
  return median({power.begin(), power.end()}) / std::log(2.0);
}

}  // namespace

Sign above_white_floor(const Leftover& record) {
  Sign sign{SignKind::above_white_floor, 0.0};
  const auto power = periodogram(record.residual, record.step_s).power;
  const std::span<const double> all(power);
  const std::size_t quarter = all.size() / 4;
  const double low = density(all.subspan(quarter, quarter));
  const double middle = density(all.subspan(2 * quarter, quarter));
  const double high = density(all.subspan(3 * quarter));
  const auto [least, most] = std::minmax({low, middle, high});
  if (!(least > 0.0) || most > kFlat * least) return sign;
  const double floor = density(all.subspan(quarter)) * static_cast<double>(all.size());
  const double total = std::accumulate(all.begin(), all.end(), 0.0);
  sign.strength =
      std::min(std::sqrt(total / floor) / kOverFloor, deviations_from_slow_noise(all) / kNoSlowNoise);
  return sign;
}

}  // namespace bodesmith::gap
