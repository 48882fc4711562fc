#include "report/scale.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/whole_number.hpp"

namespace bodesmith::report {
namespace {

constexpr std::size_t kFewestTicks = 4;

}  // namespace

std::vector<double> linear_ticks(double from, double to, int count) {
  std::vector<double> ticks;
  if (!(to > from) || count < 1) return ticks;
  const double raw = (to - from) / count;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  double step = decade;
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    step = factor * decade;
    if (step >= raw * 0.999) break;
  }
  for (double k = std::ceil(from / step - 1e-9); k * step <= to + 1e-9 * step && ticks.size() < 100;
       k += 1.0) {
    ticks.push_back(k == 0.0 ? 0.0 : k * step);
  }
  return ticks;
}

std::vector<double> logarithmic_ticks(double from, double to) {
  std::vector<double> ticks;
  const double decades = std::log10(to / from);
  // Many decades: every second or third one, so that the numbers do not run into one another.
  const int stride = whole_number(std::ceil(decades / 9.0), 1);
  const bool few =
      std::floor(std::log10(to) + 1e-9) - std::ceil(std::log10(from) - 1e-9) + 1.0 < kFewestTicks;
  const int first = whole_number(std::floor(std::log10(from)), -400, 400);
  const int last = whole_number(std::ceil(std::log10(to)), -400, 400);
  for (int e = first; e <= last; ++e) {
    if (((e % stride) + stride) % stride != 0) continue;
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1.0 && !few) continue;
      const double value = factor * std::pow(10.0, e);
      if (value >= from * (1.0 - 1e-9) && value <= to * (1.0 + 1e-9)) ticks.push_back(value);
    }
  }
  return ticks;
}

std::vector<double> logarithmic_subdivisions(double from, double to) {
  std::vector<double> out;
  for (double decade = std::pow(10.0, std::floor(std::log10(from))); decade < to; decade *= 10.0) {
    for (int k = 2; k <= 9; ++k) {
      const double value = decade * k;
      if (value >= from && value <= to) out.push_back(value);
    }
  }
  return out;
}

std::string tick_text(double value) {
  if (value != 0.0 && (std::abs(value) >= 1e5 || std::abs(value) < 1e-3)) {
    const int exponent = whole_number<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
    const double mantissa = value / std::pow(10.0, exponent);
    if (std::abs(mantissa - 1.0) < 1e-9) return fmt::format("1e{}", exponent);
    return fmt::format("{:.3g}e{}", mantissa, exponent);
  }
  return fmt::format("{:.6g}", value);
}

std::string prefixed_tick_text(double value) {
  const double size = std::abs(value);
  if (size >= 1e9) return fmt::format("{:.6g}G", value / 1e9);
  if (size >= 1e6) return fmt::format("{:.6g}M", value / 1e6);
  if (size >= 1e3) return fmt::format("{:.6g}k", value / 1e3);
  return tick_text(value);
}

Range data_range(const Plot& plot, std::vector<double> Series::*coordinate, bool logarithmic) {
  Range out{INFINITY, -INFINITY};
  for (const Series& series : plot.series) {
    for (const double value : series.*coordinate) {
      if (!std::isfinite(value) || (logarithmic && value <= 0.0)) continue;
      out.low = std::min(out.low, value);
      out.high = std::max(out.high, value);
    }
  }
  if (out.low <= out.high) return out;
  return logarithmic ? Range{1.0, 10.0} : Range{0.0, 1.0};
}

Range with_margin(Range range, bool logarithmic) {
  if (logarithmic)
    return {std::pow(10.0, std::floor(std::log10(range.low))),
            std::pow(10.0, std::ceil(std::log10(range.high)))};
  const double margin =
      range.high > range.low ? 0.06 * (range.high - range.low) : std::max(1e-12, 0.1 * std::abs(range.high));
  return {range.low - margin, range.high + margin};
}

std::vector<double> Scale::ticks(int count) const {
  std::vector<double> out = logarithmic ? logarithmic_ticks(from, to) : linear_ticks(from, to, count);
  // Within a decade, or where steps of 1, 2 and 5 fall badly.
  for (int more = logarithmic ? count : count + 1; out.size() < kFewestTicks && more < 4 * count; ++more)
    out = linear_ticks(from, to, more);
  return out;
}

Scale make_scale(const Axis& axis, Range range, double pixel_from, double pixel_to) {
  if (axis.fixed) range = {axis.from, axis.to};
  if (!(range.high > range.low)) range.high = axis.logarithmic ? range.low * 10.0 : range.low + 1.0;
  return {axis.logarithmic, range.low, range.high, pixel_from, pixel_to};
}

}  // namespace bodesmith::report
