#include "fpaa/plan/clock_features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/whole_number.hpp"
#include "numeric/quadratic_roots.hpp"

namespace bodesmith::fpaa {
namespace {

void add_poles(std::vector<ClockedPole>& out, Hertz clock, const std::vector<Complex>& in_d) {
  for (const Complex& d : in_d) {
    if (d == 1.0) continue;  // z infinite
    const Complex s = -std::log(1.0 - d) * clock.value / (2.0 * std::numbers::pi);
    if (std::abs(s) < kNarrow * clock.value && std::abs(s) > 0.0) out.push_back({clock, s});
  }
}

/// That a multiple of one clock is one of a faster clock, too: its lines are counted there.
bool is_of_faster(std::span<const double> clocks_hz, std::size_t clock, double multiple) {
  return std::ranges::any_of(clocks_hz, [&](double other) {
    const double turns = multiple * clocks_hz[clock] / other;
    return other > clocks_hz[clock] && std::abs(turns - std::round(turns)) < 1e-6;
  });
}

/// Panels that grow by `ratio` from `low` over `middle` (where it lies between them) to `high`.
std::vector<double> panels(double low, double middle, double high, double ratio) {
  std::vector<double> edges{low};
  for (const double end : {middle, high}) {
    const double begin = edges.back();
    if (!(end > begin) || end > high) continue;
    const int count = whole_number(std::ceil(std::log(end / begin) / std::log(ratio)), 1);
    for (int i = 1; i <= count; ++i)
      edges.push_back(begin * std::pow(end / begin, static_cast<double>(i) / count));
  }
  return edges;
}

/// One clock's sines.
void add_image_sines(std::vector<BandSine>& out, std::span<const double> clocks_hz, std::size_t clock,
                     Band band, double ratio) {
  const double from = band.from.value, to = band.to.value, hz = clocks_hz[clock];
  const auto add = [&](double end, double other, double times) {
    const double low = std::max(std::min(end, other), from), high = std::min(std::max(end, other), to);
    if (low < high) out.push_back({{std::sqrt(low * high)}, times * std::log(high / low), clock});
  };
  // Lines leave the band at these distances from a multiple.
  std::vector<double> beside =
      panels(std::min(from, 0.4 * hz), std::abs(std::remainder(to, hz)), 0.5 * hz, ratio);
  for (std::size_t i = 1; i < beside.size(); ++i) add(beside[i - 1], beside[i], 1.0);
  beside.insert(beside.begin(), 0.0);
  for (double k = 1.0; (k - 0.5) * hz < to;) {
    // Of multiples close together (to what is in front of the clock) one in the middle stands for all that have a line of its own
    // next to 0, one for all that have not.
    const double count = std::max(1.0, std::floor(0.5 * k * (ratio - 1.0)));
    for (const bool of_faster : {false, true}) {
      double sum = 0.0, middle = 0.0;
      for (double m = k; m < k + count && (m - 0.5) * hz < to; ++m) {
        if (is_of_faster(clocks_hz, clock, m) != of_faster) continue;
        sum += 1.0 / m;
        if (middle == 0.0 || m <= k + 0.5 * count) middle = m;
      }
      for (std::size_t i = 1; i < beside.size() && middle > 0.0; ++i) {
        for (const double side : {-1.0, 1.0})
          add(middle * hz + side * beside[i - 1], middle * hz + side * beside[i], sum * middle);
      }
    }
    k += count;
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
  std::vector<BandSine> out;
  for (double ratio = 1.4; ratio < 100.0; ratio *= 1.4) {
    out.clear();
    for (std::size_t clock = 0; clock < clocks_hz.size(); ++clock) {
      if (clocks_hz[clock] < 2.0 * band.to.value) add_image_sines(out, clocks_hz, clock, band, ratio);
    }
    if (static_cast<double>(out.size()) <= most) break;
  }
  for (BandSine& sine : out) sine.share /= std::log(band.to.value / band.from.value);
  return out;
}

std::vector<double> clock_lines_hz(std::span<const double> clocks_hz, std::size_t clock, double sine_hz,
                                   Band band) {
  constexpr int kFirstMultiples = 12;
  constexpr int kNearZero = 3;
  std::vector<double> out;
  const double hz = clocks_hz[clock];
  const auto add = [&](double k) {
    const double line = k * hz + sine_hz;
    if (std::abs(line) >= band.from.value && std::abs(line) <= band.to.value &&
        !is_of_faster(clocks_hz, clock, k))
      out.push_back(line);
  };
  for (int k = -kFirstMultiples; k <= kFirstMultiples; ++k) {
    if (k != 0) add(k);
  }
  const double nearest = -std::round(sine_hz / hz);
  for (int by = -kNearZero; by <= kNearZero; ++by) {
    if (std::abs(nearest + by) > kFirstMultiples) add(nearest + by);
  }
  return out;
}

}  // namespace bodesmith::fpaa
