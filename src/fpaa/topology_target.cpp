#include "fpaa/topology_target.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/whole_number.hpp"
#include "fpaa/error_reference.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

constexpr double kBeyondBand = 50.0;
constexpr double kBeyondWeight = 0.3;
constexpr double kClockOverFrequency = 160.0;
/// A zero of the wanted response on the axis: errors near it count against this share of the peak.
constexpr double kSoftZero = 1e-5;

}  // namespace

NetworkTarget network_target(const Sections& sections, Band band, double fast_clock_hz, const Board& board) {
  constexpr double kPointsPerDecade = 18.0;
  NetworkTarget out;
  out.band = band;
  out.master_hz = board.master_clock.value;
  out.max_capacitor = board.max_capacitor;
  const auto points = [](Band b) {
    const double decades = std::log10(b.to.value / b.from.value);
    return whole_number<int>(kPointsPerDecade * decades, 36, 130);
  };
  const auto add = [&](Hertz f, double weight) {
    out.grid.push_back(f.rad_s());
    out.wanted.push_back(sections.response(f.rad_s()));
    out.weight.push_back(weight);
  };
  for (const Hertz f : log_grid(band, points(band))) add(f, 1.0);
  const double end = std::min(kBeyondBand * band.to.value, fast_clock_hz / kClockOverFrequency);
  if (end > 1.3 * band.to.value) {
    const Band beyond{{1.15 * band.to.value}, {end}};
    for (const Hertz f : log_grid(beyond, 20)) add(f, kBeyondWeight);
  }
  double peak = 0.0;
  for (const Complex& h : out.wanted) peak = std::max(peak, std::abs(h));
  for (const RadPerSecond w : out.grid) {
    out.reciprocal.push_back(1.0 / std::max(error_reference(sections, w), kSoftZero * peak));
  }
  return out;
}

NetworkTarget seen_closer(NetworkTarget target, const Network& network, const Sections& sections) {
  const Band band = target.band;
  constexpr int kCloser = 240;
  const double soft = 1.0 / *std::max_element(target.reciprocal.begin(), target.reciprocal.end());
  const auto add = [&](Hertz f) {
    const Complex wanted = sections.response(f.rad_s());
    target.grid.push_back(f.rad_s());
    target.wanted.push_back(wanted);
    target.weight.push_back(1.0);
    target.reciprocal.push_back(1.0 / std::max(error_reference(sections, f.rad_s()), soft));
  };
  for (const Hertz f : log_grid(band, kCloser)) add(f);
  for (const NetworkStage& stage : network.stages) {
    for (const double multiple : {0.5, 0.97, 1.03, 1.5, 1.97, 2.03}) {
      const Hertz f{multiple * target.master_hz / static_cast<double>(stage.divisor)};
      if (f >= band.from && f <= band.to) add(f);
    }
  }
  constexpr double kBeside[] = {-10.0, -3.0, -1.0, -0.5, -0.2, 0.2, 0.5, 1.0, 3.0, 10.0};
  for (const Hertz f : near_clocks(clocked_poles(network, target.master_hz), band, kBeside, 20)) add(f);
  return target;
}

NetworkTarget with_clocks_seen(NetworkTarget target, const std::vector<ClockedPole>& poles,
                               const Sections& sections) {
  constexpr double kBeside[] = {-3.0, -0.6, 0.2, 0.6, 3.0};
  constexpr int kMultiples = 4;
  const double soft = 1.0 / *std::max_element(target.reciprocal.begin(), target.reciprocal.end());
  for (const Hertz f : near_clocks(poles, target.band, kBeside, kMultiples)) {
    target.grid.push_back(f.rad_s());
    target.wanted.push_back(sections.response(f.rad_s()));
    target.weight.push_back(1.0);
    target.reciprocal.push_back(1.0 / std::max(error_reference(sections, f.rad_s()), soft));
  }
  return target;
}

std::vector<ClockedPole> clocked_poles(const std::vector<ParallelPath>& paths, double master_hz) {
  std::vector<ClockedPole> out;
  for (const ParallelPath& path : paths) {
    out.push_back({{master_hz / static_cast<double>(path.divisor)}, path.pole / (2.0 * std::numbers::pi)});
  }
  return out;
}

}  // namespace bodesmith::fpaa
