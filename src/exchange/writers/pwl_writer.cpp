// Times and values, one pair a line: LTspice's PWL file="…", KiCad, and ngspice's filesource.
// A voltage source with its points inside, to be included by any SPICE: `.include drive.inc` gives V<name> at node <name>.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "exchange/writer.hpp"

namespace bodesmith::exchange {
namespace {

/// Times (from 0 on) and values of the signal asked for, and what is to be said of them. Points on the straight line
/// between their neighbours are left out: a source draws that line itself.
struct PwlPoints {
  std::vector<std::pair<double, double>> points;
  std::vector<std::string> said;
};

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

class PwlWriter : public Writer {
 public:
  PwlWriter() : Writer("pwl", ".pwl .txt", "times and values for LTspice's PWL file=") {}
  Written write(const Exportable& from, const ExportOptions& options) const override {
    PwlPoints points = pwl_points(from, *this, options);
    Written out;
    for (const auto& [time, value] : points.points)
      out.content += number_text(time) + " " + number_text(value) + "\n";
    out.said = std::move(points.said);
    return out;
  }
};

class SpiceSourceWriter : public Writer {
 public:
  SpiceSourceWriter() : Writer("spice-source", ".inc .lib", "a voltage source PWL(…) for any SPICE") {}
  Written write(const Exportable& from, const ExportOptions& options) const override {
    PwlPoints points = pwl_points(from, *this, options);
    Written out;
    out.content = fmt::format("* {}\nV{} {} 0 PWL(", from.source, from.name, from.name);
    for (const auto& [time, value] : points.points)
      out.content += fmt::format("\n+ {} {}", number_text(time), number_text(value));
    out.content += ")\n";
    out.said = std::move(points.said);
    out.said.push_back(fmt::format("source V{} between node {} and ground", from.name, from.name));
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, pwl_writer, PwlWriter)

BODESMITH_ENTRY(Writer, spice_source_writer, SpiceSourceWriter)

}  // namespace bodesmith::exchange
