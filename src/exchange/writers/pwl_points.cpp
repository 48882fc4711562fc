#include "exchange/writers/pwl_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::exchange {

PwlPoints pwl_points(const Exportable& from, const Writer& writer, const ExportOptions& options) {
  const TimeRecord& record = need_record(from, writer);
  if (options.output_signal && record.y.empty())
    throw InputError(from.source, 0, "has no y, expected a second signal");
  const std::vector<double>& v = options.output_signal ? record.y : record.u;
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  // Rounding of the samples alone must not keep a point.
  const double same = 4e-16 * std::max(std::abs(*low), std::abs(*high));
  PwlPoints out;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const bool inner = i > 0 && i + 1 < v.size();
    if (inner && std::abs(v[i] - v[i - 1]) <= same && std::abs(v[i + 1] - v[i]) <= same) continue;
    out.points.emplace_back(record.step_s * static_cast<double>(i), v[i]);
  }
  out.said.push_back(
      fmt::format("{} in volts, {} points", options.output_signal ? "y" : "u", out.points.size()));
  if (out.points.size() < v.size())
    out.said.push_back(fmt::format("{} points on level stretches left out", v.size() - out.points.size()));
  if (record.start_s != 0.0)
    out.said.push_back(
        fmt::format("times moved by {} so that they begin at 0", engineering_text(-record.start_s, "s", 6)));
  return out;
}

}  // namespace bodesmith::exchange
