#include "signal/extent.hpp"

#include <algorithm>
#include <cmath>

#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith {
namespace {

void add_band(SignalExtent& out, std::vector<double> u, double step_s, bool first) {
  const double middle = mean(u);
  for (double& v : u) v -= middle;
  const Periodogram bins = periodogram(u, step_s);
  double total = 0.0;
  for (const double power : bins.power) total += power;
  if (!(total > 0.0)) return;
  double sum = 0.0;
  double from = -1.0;
  double to = 0.0;
  for (std::size_t k = 0; k < bins.power.size(); ++k) {
    sum += bins.power[k];
    const double f = bins.bin_hz * static_cast<double>(k);
    if (from < 0.0 && sum >= 0.0005 * total) from = f;
    to = f;
    if (sum >= 0.9995 * total) break;
  }
  out.from_hz = first ? from : std::min(out.from_hz, from);
  out.to_hz = first ? to : std::max(out.to_hz, to);
}

}  // namespace

SignalExtent input_extent(std::span<const TimeRecord> records, double skip_s) {
  SignalExtent out;
  bool first = true;
  for (const TimeRecord& record : records) {
    const double skipped =
        std::min(std::ceil(skip_s / record.step_s), static_cast<double>(record.size() - 1));
    const auto begin = record.u.begin() + static_cast<std::ptrdiff_t>(skipped);
    const std::vector<double> u(begin, record.u.end());
    const auto [low, high] = std::minmax_element(u.begin(), u.end());
    out.lower = first ? *low : std::min(out.lower, *low);
    out.upper = first ? *high : std::max(out.upper, *high);
    for (std::size_t i = 1; i < u.size(); ++i)
      out.max_rate_per_s = std::max(out.max_rate_per_s, std::abs(u[i] - u[i - 1]) / record.step_s);
    if (u.size() >= 8) add_band(out, u, record.step_s, first);
    first = false;
  }
  return out;
}

}  // namespace bodesmith
