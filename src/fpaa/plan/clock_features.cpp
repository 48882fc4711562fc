#include "fpaa/plan/clock_features.hpp"
#include "numeric/quadratic_roots.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith::fpaa {
namespace {

void add_poles(std::vector<ClockedPole>& out, Hertz clock, const std::vector<Complex>& in_d) {
  for (const Complex& d : in_d) {
    if (d == 1.0) continue;  // z infinite
    const Complex s = -std::log(1.0 - d) * clock.value / (2.0 * std::numbers::pi);
    if (std::abs(s) < kNarrow * clock.value && std::abs(s) > 0.0) out.push_back({clock, s});
  }
}

}  // namespace

std::vector<ClockedPole> clocked_poles(const Plan& plan) {
  std::vector<ClockedPole> out;
  for (const PlacedCam* cam : plan.cams()) {
    std::vector<double> below = in_one_minus(cam->z.denominator);
    if (below.size() > 3) continue;
    below.resize(3, 0.0);
    add_poles(out, cam->clock_a, quadratic_roots(below[0], below[1], below[2]));
  }
  return out;
}

std::vector<Hertz> near_clocks(const std::vector<ClockedPole>& poles, Band band,
                               std::span<const double> offsets, int multiples) {
  std::vector<Hertz> out;
  for (const ClockedPole& pole : poles) {
    const double width = std::abs(pole.pole_hz.real());
    const double apart = std::abs(pole.pole_hz.imag());
    const double reach = apart + 30.0 * width;
    if (pole.clock.value - reach > band.to.value) continue;
    for (int k = 1; k <= multiples && k * pole.clock.value - reach <= band.to.value; ++k) {
      for (const double offset : offsets) {
        for (const double side : {-apart, apart}) {
          const Hertz f{k * pole.clock.value + side + offset * width};
          if (f >= band.from && f <= band.to) out.push_back(f);
          if (apart == 0.0) break;
        }
      }
    }
  }
  std::ranges::sort(out, {}, &Hertz::value);
  out.erase(std::unique(out.begin(), out.end(), [](Hertz a, Hertz b) { return a.value == b.value; }),
            out.end());
  return out;
}

std::vector<BandSine> image_sines(std::span<const double> clocks_hz, Band band, double most) {
  constexpr int kSpread = 96;
  constexpr double kOutside =
      0.999;  // of the distance at which a sine's line lies at an edge of the band: there it comes in
  const double from = band.from.value, to = band.to.value;
  std::vector<double> at_hz;
  for (double ratio = 1.5;; ratio *= ratio) {
    const bool spread_alone = ratio > to / from;
    at_hz.clear();
    for (const Hertz f : log_grid(band, kSpread)) at_hz.push_back(f.value);
    for (const double clock : clocks_hz) {
      for (double at = clock; at < 2.0 * to && !spread_alone; at += clock) {
        const auto add = [&](double away) {
          for (const double hz : {at - away, at + away}) {
            if (hz > from && hz < to) at_hz.push_back(hz);
          }
        };
        for (const double edge : {from, to}) add(kOutside * edge), add(edge / kOutside);
        for (double away = ratio * from; away < 0.5 * clock; away *= ratio) add(away);
      }
    }
    if (static_cast<double>(at_hz.size()) <= most || spread_alone) break;
  }
  std::ranges::sort(at_hz);
  const double whole = std::log(at_hz.back() / at_hz.front());
  std::vector<BandSine> out;
  for (std::size_t i = 0; i < at_hz.size(); ++i) {
    const double low = at_hz[i == 0 ? 0 : i - 1], high = at_hz[std::min(i + 1, at_hz.size() - 1)];
    out.push_back({{at_hz[i]}, 0.5 * std::log(high / low) / whole});
  }
  return out;
}

std::vector<double> clock_lines_hz(std::span<const double> clocks_hz, double sine_hz, Band band) {
  constexpr int kFirstMultiples = 12;
  constexpr int kNearZero = 3;
  std::vector<double> out;
  for (const double clock : clocks_hz) {
    const auto add = [&](double k) {
      const double line = k * clock + sine_hz;
      const bool within = std::abs(line) >= band.from.value && std::abs(line) <= band.to.value;
      const bool known =
          std::ranges::any_of(out, [&](double other) { return std::abs(other - line) < 1e-6 * clock; });
      if (within && !known) out.push_back(line);
    };
    for (int k = -kFirstMultiples; k <= kFirstMultiples; ++k) {
      if (k != 0) add(k);
    }
    const double nearest = -std::round(sine_hz / clock);
    for (int by = -kNearZero; by <= kNearZero; ++by) {
      if (std::abs(nearest + by) > kFirstMultiples) add(nearest + by);
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
