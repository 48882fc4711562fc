#include "faults/measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "signal/bode_points.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::faults {
namespace {

/// No instrument of a workshop measures better: 0.0017 dB, 0.011 degrees.
constexpr double kLeastNoise = 2e-4;
constexpr double kAboveFloor = 5.0;
/// Median of |x| of a standard normal x.
constexpr double kMedianOfNormal = 0.6745;

/// Misfits of each inner value to the line through its neighbours, scaled to the deviation of one value.
void add_misfits(const Channel& channel, const double* value, const double* floors,
                 std::vector<double>& out) {
  const std::vector<Hertz>& grid = channel.grid;
  const auto is_low = [&](std::size_t i) { return std::exp(channel.log_gain[i]) < kAboveFloor * floors[i]; };
  for (std::size_t i = 1; i + 1 < grid.size(); ++i) {
    if (is_low(i - 1) || is_low(i) || is_low(i + 1)) continue;
    const double left = std::log(grid[i].value / grid[i - 1].value);
    const double right = std::log(grid[i + 1].value / grid[i].value);
    const double a = right / (left + right);
    const double misfit = value[i] - a * value[i - 1] - (1.0 - a) * value[i + 1];
    out.push_back(std::abs(misfit) / std::sqrt(1.0 + a * a + (1.0 - a) * (1.0 - a)));
  }
}

double deviation_of(std::vector<double> misfits) {
  if (misfits.empty()) return 3e-3;  // two points tell nothing: a good instrument
  return std::max(median(std::move(misfits)) / kMedianOfNormal, kLeastNoise);
}

}  // namespace

Channel read_channel(const std::filesystem::path& path, const std::string& node, Provenance& from) {
  constexpr std::size_t kMostPoints = 121;
  const BodePoints points = BodePoints::read_csv(path, from);
  if (points.points.size() < 3)
    throw InputError(
        fmt::format("{}: has {} points, expected at least 3", points.file, points.points.size()));
  Channel out;
  out.file = points.file;
  out.node = node;
  out.measured_points = points.points.size();
  const bool with_phase = points.points.front().phase_deg.has_value();
  for (const BodePoint& p : points.points) {
    if (p.phase_deg.has_value() != with_phase)
      throw InputError(points.file, p.line, "phase_deg is there in some rows only, expected all or none");
  }
  const std::size_t kept = std::min(points.points.size(), kMostPoints);
  for (std::size_t i = 0; i < kept; ++i) {
    const std::size_t at = kept == 1 ? 0 : i * (points.points.size() - 1) / (kept - 1);
    const BodePoint& p = points.points[at];
    out.grid.push_back(p.frequency);
    out.log_gain.push_back(std::log(p.gain));
    if (with_phase) out.phase_rad.push_back(to_radians(*p.phase_deg));
  }
  return out;
}

std::size_t Measurement::points() const {
  std::size_t sum = 0;
  for (const Channel& channel : channels) sum += channel.grid.size();
  return sum;
}

Noise rough_noise(const Measurement& measured, const std::vector<double>& gain,
                  const std::vector<double>& phase, const std::vector<double>& floors) {
  std::vector<double> of_gain;
  std::vector<double> of_phase;
  std::size_t first = 0;
  for (const Channel& channel : measured.channels) {
    add_misfits(channel, gain.data() + first, floors.data() + first, of_gain);
    if (!channel.phase_rad.empty())
      add_misfits(channel, phase.data() + first, floors.data() + first, of_phase);
    first += channel.grid.size();
  }
  Noise out;
  out.gain = deviation_of(of_gain);
  out.phase = of_phase.empty() ? out.gain : deviation_of(of_phase);
  return out;
}

}  // namespace bodesmith::faults
