#include "lti/loop_margins.hpp"

#include "numeric/golden_section.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/json.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// Where `value` changes its sign between two frequencies, by halving in log frequency.
Hertz sign_change(const std::function<double(Hertz)>& value, Hertz from, Hertz to) {
  const bool rising = value(from) < 0.0;
  double low = std::log(from.value);
  double high = std::log(to.value);
  while (high - low > 1e-13) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (value(Hertz{std::exp(middle)}) < 0.0) == rising ? low = middle : high = middle;
  }
  return Hertz{std::exp(0.5 * (low + high))};
}

LoopMargins::GainCrossing gain_crossing(const Loop& loop, Hertz f) {
  const Complex l = loop(f);
  LoopMargins::GainCrossing out{f, to_degrees(std::arg(-l)), 0.0};
  double turn = std::arg(-l);
  if (turn < 0.0) turn += 2.0 * std::numbers::pi;
  out.delay_margin_s = turn / f.rad_s().value;
  return out;
}

/// Largest of `value` near the best of a grid, by golden sections in log frequency.
Hertz refine_peak(const std::function<double(Hertz)>& value, const std::vector<Hertz>& grid,
                  std::size_t best) {
  const double low = std::log(grid[best > 0 ? best - 1 : 0].value);
  const double high = std::log(grid[std::min(best + 1, grid.size() - 1)].value);
  return Hertz{std::exp(
      golden_section_minimum(low, high, 1e-9, [&](double x) { return -value(Hertz{std::exp(x)}); }))};
}

/// Change of arg(1 + L) between two frequencies, halved until no step turns far. Nothing when that does not end.
std::optional<double> turn_of(const std::function<Complex(double)>& at, double from, Complex a, double to,
                              Complex b, int depth) {
  if (a == 0.0 || b == 0.0) return std::nullopt;
  const double whole = std::arg(b / a);
  const double middle = 0.5 * (from + to);
  const Complex c = at(middle);
  if (c == 0.0) return std::nullopt;
  const double first = std::arg(c / a);
  const double second = std::arg(b / c);
  if (std::abs(first) + std::abs(second) < 0.5 && std::abs(first + second - whole) < 1e-6)
    return first + second;
  if (depth == 0) return std::nullopt;
  const auto left = turn_of(at, from, a, middle, c, depth - 1);
  if (!left) return std::nullopt;
  const auto right = turn_of(at, middle, c, to, b, depth - 1);
  if (!right) return std::nullopt;
  return *left + *right;
}

}  // namespace

const LoopMargins::GainCrossing* LoopMargins::least_phase_margin() const {
  const auto least =
      std::min_element(gain_crossings.begin(), gain_crossings.end(), [](const auto& a, const auto& b) {
        return std::abs(a.phase_margin_deg) < std::abs(b.phase_margin_deg);
      });
  return least == gain_crossings.end() ? nullptr : &*least;
}

const LoopMargins::PhaseCrossing* LoopMargins::least_gain_margin() const {
  const auto least = std::min_element(
      phase_crossings.begin(), phase_crossings.end(),
      [](const auto& a, const auto& b) { return std::abs(a.gain_margin_db) < std::abs(b.gain_margin_db); });
  return least == phase_crossings.end() ? nullptr : &*least;
}

LoopMargins loop_margins(const Loop& loop, const std::vector<Hertz>& grid) {
  LoopMargins out;
  const auto excess = [&loop](Hertz f) { return std::log(std::abs(loop(f))); };
  const auto imaginary = [&loop](Hertz f) { return loop(f).imag(); };
  const auto sensitivity = [&loop](Hertz f) { return 1.0 / std::abs(1.0 + loop(f)); };
  std::size_t peak = 0;
  Complex before;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Complex now = loop(grid[i]);
    if (const double s = 1.0 / std::abs(1.0 + now); i == 0 || s > out.max_sensitivity) {
      out.max_sensitivity = s;
      peak = i;
    }
    if (i > 0) {
      if ((std::abs(before) < 1.0) != (std::abs(now) < 1.0))
        out.gain_crossings.push_back(gain_crossing(loop, sign_change(excess, grid[i - 1], grid[i])));
      if ((before.imag() < 0.0) != (now.imag() < 0.0)) {
        const Hertz f = sign_change(imaginary, grid[i - 1], grid[i]);
        // Through 0 by way of infinity, or on the positive side, is no crossing of -180 degrees.
        const Complex l = loop(f);
        if (l.real() < 0.0 && std::abs(l.imag()) < 1e-3 * std::abs(l))
          out.phase_crossings.push_back({f, -to_decibel(std::abs(l))});
      }
    }
    before = now;
  }
  if (!grid.empty()) {
    out.max_sensitivity_at = refine_peak(sensitivity, grid, peak);
    out.max_sensitivity = std::max(out.max_sensitivity, sensitivity(out.max_sensitivity_at));
  }
  return out;
}

std::optional<bool> closed_loop_is_stable(const Sections& loop) {
  int integrators = 0;
  for (const Section& section : loop.sections) {
    for (const Complex& p : section.poles) {
      if (p == 0.0) {
        ++integrators;
      } else if (!(p.real() < 0.0)) {
        return std::nullopt;
      }
    }
  }
  const Band corners = loop.corner_band();
  if (!(corners.to.value > 0.0)) return std::nullopt;
  const auto at = [&loop](double log_w) { return 1.0 + loop.response(Complex(0.0, std::exp(log_w))); };
  const double from = std::log(corners.from.rad_s().value) - 14.0;
  const double to = std::log(corners.to.rad_s().value) + 14.0;
  // With a delay and a gain of 1 or more at high frequencies the turns never end.
  double high = loop.gain;
  for (const Section& section : loop.sections) high *= section.high_frequency_gain();
  if (loop.delay_s > 0.0 && std::abs(high) >= 1.0) return false;
  double turns = 0.0;
  constexpr int kPieces = 200;
  for (int i = 0; i < kPieces; ++i) {
    const double a = from + (to - from) * i / kPieces;
    const double b = from + (to - from) * (i + 1) / kPieces;
    const auto turn = turn_of(at, a, at(a), b, at(b), 24);
    if (!turn) return std::nullopt;
    turns += *turn;
  }
  return std::abs(turns - 0.5 * std::numbers::pi * integrators) < 0.5 * std::numbers::pi;
}

Json to_json(const LoopMargins& margins) {
  Json out = {{"gain_crossings", Json::array()},
              {"phase_crossings", Json::array()},
              {"max_sensitivity", margins.max_sensitivity},
              {"max_sensitivity_hz", margins.max_sensitivity_at.value}};
  for (const auto& c : margins.gain_crossings) {
    out["gain_crossings"].push_back({{"frequency_hz", c.frequency.value},
                                     {"phase_margin_deg", c.phase_margin_deg},
                                     {"delay_margin_s", c.delay_margin_s}});
  }
  for (const auto& c : margins.phase_crossings)
    out["phase_crossings"].push_back(
        {{"frequency_hz", c.frequency.value}, {"gain_margin_db", c.gain_margin_db}});
  return out;
}

}  // namespace bodesmith
