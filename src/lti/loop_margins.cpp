#include "lti/loop_margins.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/documents/json.hpp"
#include "numeric/optimisation/minimum.hpp"
#include "numeric/optimisation/root.hpp"

namespace bodesmith {
namespace {

/// ln |L|, within what a search for its zero can reckon with.
double log_gain(Complex l) {
  constexpr double kMost = 700.0;  // of ln of a double
  return std::clamp(std::log(std::abs(l)), -kMost, kMost);
}

/// The sine of its phase.
double sine_of(Complex l) {
  return l == 0.0 ? 0.0 : l.imag() / std::abs(l);
}

/// Where `value` of the loop changes its sign between two frequencies.
Hertz sign_change(const Loop& loop, double (*value)(Complex), Hertz from, Hertz to) {
  const auto at = [&](double log_f) { return value(loop(Hertz{std::exp(log_f)})); };
  // exp(log(f)) may round across a zero that lies on the grid.
  return Hertz{std::exp(root_between(at, std::log(from.value), std::log(to.value)))};
}

LoopMargins::GainCrossing gain_crossing(const Loop& loop, Hertz f) {
  const Complex l = loop(f);
  LoopMargins::GainCrossing out{f, to_degrees(std::arg(-l)), 0.0};
  double turn = std::arg(-l);
  if (turn < 0.0) turn += 2.0 * std::numbers::pi;
  out.delay_margin_s = turn / f.rad_s().value;
  return out;
}

std::vector<Complex> on_grid(const Loop& loop, const std::vector<Hertz>& grid) {
  std::vector<Complex> out;
  for (const Hertz f : grid) out.push_back(loop(f));
  return out;
}

/// A loop at frequencies that step over no crossing.
struct LoopOnGrid {
  std::vector<Hertz> grid;
  std::vector<Complex> values;
};

/// On the grid and where it steps over two crossings: between the neighbours of a point at which |L| is nearest to 1, or L to the
/// negative real axis, the place where it has crossed, if it has; it comes back within these two steps.
LoopOnGrid with_double_crossings(const Loop& loop, std::vector<Hertz> grid) {
  std::vector<Complex> values = on_grid(loop, grid);
  std::vector<Hertz> found;
  for (double (*value)(Complex) : {log_gain, sine_of}) {
    for (std::size_t i = 1; i + 1 < grid.size(); ++i) {
      const double here = value(values[i]);
      const double sign = here < 0.0 ? -1.0 : 1.0;
      const bool nearest =
          sign * value(values[i - 1]) >= sign * here && sign * value(values[i + 1]) >= sign * here;
      if (!nearest || here == 0.0 || (value == sine_of && values[i].real() > 0.0)) continue;
      const auto side = [&](double log_f) { return sign * value(loop(Hertz{std::exp(log_f)})); };
      const double at = minimum_between(std::log(grid[i - 1].value), std::log(grid[i + 1].value), 1e-9, side);
      if (side(at) < 0.0) found.push_back(Hertz{std::exp(at)});
    }
  }
  if (!found.empty()) {
    grid.insert(grid.end(), found.begin(), found.end());
    std::ranges::sort(grid);
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    values = on_grid(loop, grid);
  }
  return {std::move(grid), std::move(values)};
}

std::vector<LoopMargins::GainCrossing> gain_crossings(const Loop& loop, const std::vector<Hertz>& grid,
                                                      const std::vector<Complex>& values) {
  std::vector<LoopMargins::GainCrossing> out;
  for (std::size_t i = 1; i < grid.size(); ++i) {
    if ((std::abs(values[i - 1]) < 1.0) != (std::abs(values[i]) < 1.0))
      out.push_back(gain_crossing(loop, sign_change(loop, log_gain, grid[i - 1], grid[i])));
  }
  return out;
}

std::vector<LoopMargins::PhaseCrossing> phase_crossings(const Loop& loop, const std::vector<Hertz>& grid,
                                                        const std::vector<Complex>& values) {
  std::vector<LoopMargins::PhaseCrossing> out;
  for (std::size_t i = 1; i < grid.size(); ++i) {
    if ((values[i - 1].imag() < 0.0) == (values[i].imag() < 0.0)) continue;
    const Hertz f = sign_change(loop, sine_of, grid[i - 1], grid[i]);
    // Through 0 by way of infinity, or on the positive side, is no crossing of -180 degrees.
    const Complex l = loop(f);
    if (l.real() < 0.0 && std::abs(l.imag()) < 1e-3 * std::abs(l))
      out.push_back({f, -to_decibel(std::abs(l))});
  }
  return out;
}

/// How far 1 + L turns round 0 over the grid. Near -1 a step of the grid may go half round it: the crossings, on either side
/// of -1, are steps as well.
double turn_with_crossings(const Loop& loop, const LoopOnGrid& sampled, const LoopMargins& found) {
  std::vector<std::pair<Hertz, Complex>> at;
  for (std::size_t i = 0; i < sampled.grid.size(); ++i) at.emplace_back(sampled.grid[i], sampled.values[i]);
  for (const auto& crossing : found.gain_crossings)
    at.emplace_back(crossing.frequency, loop(crossing.frequency));
  for (const auto& crossing : found.phase_crossings)
    at.emplace_back(crossing.frequency, loop(crossing.frequency));
  std::ranges::sort(at, [](const auto& a, const auto& b) { return a.first < b.first; });
  double out = 0.0;
  for (std::size_t i = 1; i < at.size(); ++i)
    if (at[i - 1].second != -1.0) out += std::arg((1.0 + at[i].second) / (1.0 + at[i - 1].second));
  return out;
}

/// Largest of `value` near the best of a grid.
Hertz refine_peak(const std::function<double(Hertz)>& value, const std::vector<Hertz>& grid,
                  std::size_t best) {
  const double low = std::log(grid[best > 0 ? best - 1 : 0].value);
  const double high = std::log(grid[std::min(best + 1, grid.size() - 1)].value);
  return Hertz{
      std::exp(minimum_between(low, high, 1e-9, [&](double x) { return -value(Hertz{std::exp(x)}); }))};
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
  const auto least = std::ranges::min_element(
      gain_crossings, {}, [](const GainCrossing& at) { return std::abs(at.phase_margin_deg); });
  return least == gain_crossings.end() ? nullptr : &*least;
}

const LoopMargins::PhaseCrossing* LoopMargins::least_gain_margin() const {
  const auto least = std::ranges::min_element(
      phase_crossings, {}, [](const PhaseCrossing& at) { return std::abs(at.gain_margin_db); });
  return least == phase_crossings.end() ? nullptr : &*least;
}

double LoopMargins::phase_margin_deg() const {
  const GainCrossing* least = least_phase_margin();
  const double size = least == nullptr ? 180.0 : std::abs(least->phase_margin_deg);
  return encircles ? -size : size;
}

std::optional<double> LoopMargins::gain_margin_db() const {
  std::optional<double> out;
  if (lowest.real() < 0.0) out = -to_decibel(-lowest.real());
  for (const PhaseCrossing& c : phase_crossings)
    out = std::min(out.value_or(c.gain_margin_db), c.gain_margin_db);
  return out;
}

Loop interpolated_loop(std::vector<Hertz> grid, std::vector<Complex> values) {
  return [grid = std::move(grid), values = std::move(values)](Hertz f) {
    const auto above = std::upper_bound(grid.begin(), grid.end(), f);
    const auto i = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(above - grid.begin(), 1, static_cast<std::ptrdiff_t>(grid.size()) - 1));
    const double t = std::log(f.value / grid[i - 1].value) / std::log(grid[i].value / grid[i - 1].value);
    const Complex a = values[i - 1];
    const Complex b = values[i];
    if (a == 0.0 || b == 0.0) return a + t * (b - a);
    return a * std::polar(std::pow(std::abs(b / a), t), t * std::arg(b / a));
  };
}

std::vector<LoopMargins::GainCrossing> gain_crossings(const Loop& loop, const std::vector<Hertz>& points) {
  const auto [grid, values] = with_double_crossings(loop, points);
  return gain_crossings(loop, grid, values);
}

LoopMargins loop_margins(const Loop& loop, const std::vector<Hertz>& points) {
  LoopMargins out;
  if (points.size() < 2) return out;
  const LoopOnGrid sampled = with_double_crossings(loop, points);
  const std::vector<Hertz>& grid = sampled.grid;
  const std::vector<Complex>& values = sampled.values;
  out.lowest = values.front();
  out.gain_crossings = gain_crossings(loop, grid, values);
  out.phase_crossings = phase_crossings(loop, grid, values);
  out.encircles = std::abs(turn_with_crossings(loop, sampled, out)) > std::numbers::pi;
  const auto distance = [](Complex l) { return std::abs(1.0 + l); };
  const auto nearest =
      std::ranges::min_element(values, [&](Complex a, Complex b) { return distance(a) < distance(b); });
  const auto sensitivity = [&](Hertz f) { return 1.0 / distance(loop(f)); };
  out.max_sensitivity_at = refine_peak(sensitivity, grid, static_cast<std::size_t>(nearest - values.begin()));
  out.max_sensitivity = std::max(1.0 / distance(*nearest), sensitivity(out.max_sensitivity_at));
  return out;
}

LoopMargins loop_margins(const std::vector<Hertz>& grid, const std::vector<Complex>& values) {
  return loop_margins(interpolated_loop(grid, values), grid);
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
