#include "fpaa/plan/plan_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/clock_features.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kImagesBelowHz = 1e5;
/// Where a slow path shows the beat of a sine next to its clock: first multiples, widths of its poles.
constexpr int kBeatMultiples = 4;
constexpr double kAroundClock[] = {-0.3, 0.3};
constexpr double kLeastLineHz = 1e-12;  ///< nearer to 0 it is no line

/// int_0^x sin(u)/u du, to 1e-6 (series; auxiliary functions of Abramowitz and Stegun 5.2.38-39 above 4).
double sine_integral(double x) {
  if (x <= 4.0) {
    double term = x;
    double sum = x;
    for (int n = 1; n < 20; ++n) {
      term *= -x * x / ((2.0 * n) * (2.0 * n + 1.0));
      sum += term / (2.0 * n + 1.0);
    }
    return sum;
  }
  const double y = 1.0 / (x * x);
  // f(x) and g(x) by their rational approximations.
  const double f = (std::pow(x, 8) + 38.027264 * std::pow(x, 6) + 265.187033 * std::pow(x, 4) +
                    335.677320 * x * x + 38.102495) /
                   (std::pow(x, 8) + 40.021433 * std::pow(x, 6) + 322.624911 * std::pow(x, 4) +
                    570.236280 * x * x + 157.105423) /
                   x;
  const double g = (std::pow(x, 8) + 42.242855 * std::pow(x, 6) + 302.757865 * std::pow(x, 4) +
                    352.018498 * x * x + 21.821899) /
                   (std::pow(x, 8) + 48.196927 * std::pow(x, 6) + 482.485984 * std::pow(x, 4) +
                    1114.978885 * x * x + 449.690326) *
                   y;
  return 0.5 * std::numbers::pi - f * std::cos(x) - g * std::sin(x);
}

constexpr int kStepTimes = 90;

}  // namespace

StepPeaks::StepPeaks(const std::vector<Hertz>& grid) : count_(grid.size()) {
  const double slowest = 1.0 / grid.front().rad_s().value;
  const double fastest = 1.0 / grid.back().rad_s().value;
  table_.reserve(kStepTimes * count_);
  for (int i = 0; i < kStepTimes; ++i) {
    const double t = fastest * std::pow(slowest / fastest, (i + 0.5) / kStepTimes);
    for (const Hertz f : grid) table_.push_back(sine_integral(f.rad_s().value * t));
  }
}

double StepPeaks::largest(const std::vector<Complex>& node) const {
  double peak = std::abs(node.front().real());
  for (int i = 0; i < kStepTimes; ++i) {
    const double* at = table_.data() + static_cast<std::size_t>(i) * count_;
    double y = node.front().real() * at[0];
    for (std::size_t k = 0; k + 1 < count_; ++k)
      y += 0.5 * (node[k].real() + node[k + 1].real()) * (at[k + 1] - at[k]);
    peak = std::max(peak, std::abs(y) * 2.0 / std::numbers::pi);
  }
  return peak;
}

std::vector<BoardNodes> nodes_over(const SwitchedBoard& board, const std::vector<Hertz>& grid) {
  std::vector<BoardNodes> out(grid.size());
  parallel_for(grid.size(), thread_count(0), [&](std::size_t k) { out[k] = board.nodes(grid[k].rad_s()); });
  return out;
}

Headroom headroom_of(const SwitchedBoard& switched, const Plan& plan, Band band) {
  constexpr int kPoints = 360;
  constexpr double kInstants = 4e7;  // half a second
  const int points =
      std::clamp(static_cast<int>(kInstants / static_cast<double>(switched.instants())), 60, kPoints);
  const std::vector<Hertz> grid =
      log_grid({{0.01 * band.from.value}, {kOfFastest * switched.fastest_clock().value}}, points);
  std::vector<std::vector<Complex>> gains;  // [op-amp][frequency]
  double sine = 1.0;                        // the input itself
  for (const auto& nodes : nodes_over(switched, grid)) {
    std::size_t opamp = 0;
    for (const auto& node : nodes) {
      for (const PeriodicNetworks::NodeSize& size : node) {
        sine = std::max(sine, size.largest);
        if (opamp == gains.size()) gains.emplace_back();
        gains[opamp++].push_back(size.gain);
      }
    }
  }
  // The beats of sines next to clocks: on resonances, and slower than the band.
  std::vector<ClockedPole> beats = clocked_poles(plan);
  for (const double clock : plan.clocks_hz()) beats.push_back({{clock}, -band.from.value});
  for (const auto& nodes :
       nodes_over(switched, near_clocks(beats, {grid.front(), grid.back()}, kAroundClock, kBeatMultiples))) {
    for (const auto& node : nodes) {
      for (const PeriodicNetworks::NodeSize& size : node) sine = std::max(sine, size.largest);
    }
  }
  double step = 1.0;
  const StepPeaks peaks(grid);
  for (const std::vector<Complex>& gain : gains) step = std::max(step, peaks.largest(gain));
  return {kFullScaleV / sine, kFullScaleV / step};
}

ImageLines images_of(const SwitchedBoard& board, const Plan& plan, Band band) {
  constexpr double kPieces = 1e6;  // of waveforms and their lines
  const std::set<double> all = plan.clocks_hz();
  const std::vector<double> clocks(all.begin(), all.end());
  constexpr int kSpread = 16;
  constexpr Band kLines{{kLeastLineHz}, {kImagesBelowHz}};
  ImageLines out;
  // The largest of these lines; the rms of those within the band.
  const auto look = [&](Hertz f, const std::vector<double>& lines) {
    std::vector<RadPerSecond> asked;
    for (const double line : lines) asked.push_back(Hertz{line}.rad_s());
    asked.push_back(f.rad_s());
    const std::vector<Complex> sizes = board.components(f.rad_s(), asked);
    const double signal = std::abs(sizes.back());
    double squares = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Hertz at{std::abs(lines[i])};
      const bool within = at >= band.from && at <= band.to;
      if (within) squares += std::norm(sizes[i]);
      if (!(signal > 0.0)) continue;
      const ImageLine line{f, at, to_decibel(std::max(std::abs(sizes[i]) / signal, 1e-15))};
      for (std::optional<ImageLine>* most : {&out.largest, within ? &out.in_band : nullptr}) {
        if (most != nullptr && (!*most || line.magnitude_db > (*most)->magnitude_db)) *most = line;
      }
    }
    return std::sqrt(squares);
  };
  for (const BandSine& sine : image_sines(clocks, band, kPieces / static_cast<double>(board.pieces()))) {
    const Hertz f = sine.frequency;
    out.sines.push_back({sine, look(f, clock_lines_hz(clocks, sine.clock, f.value, kLines))});
  }
  for (const auto& others :
       {log_grid(band, kSpread), near_clocks(clocked_poles(plan), band, kAroundClock, kBeatMultiples)}) {
    for (const Hertz f : others) {
      std::vector<double> lines;
      for (std::size_t clock = 0; clock < clocks.size(); ++clock) {
        const std::vector<double> own = clock_lines_hz(clocks, clock, f.value, kLines);
        lines.insert(lines.end(), own.begin(), own.end());
      }
      look(f, lines);
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
