#include "signal/time_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "signal/formats/table_meaning.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith {
namespace {

/// Whether every step is within 0.4 % of `step`, so that none can be 1 % off the median.
bool all_steps_near(const std::vector<double>& time, double step) {
  if (!(step > 0.0) || !std::isfinite(step)) return false;
  bool near = true;
  for (std::size_t i = 1; i < time.size(); ++i)
    near &= std::abs(time[i] - time[i - 1] - step) <= 0.004 * step;
  return near;
}

TimeRecord from_csv(const Csv& csv, std::string_view input_column, const std::optional<double>& sample_hz) {
  TimeRecord record;
  record.file = csv.file();
  const bool sampled = sample_hz && !csv.foreign();
  if (sampled && csv.has(column::time_s))
    throw InputError(csv.file(), csv.header_line(),
                     "has times, but a sampling rate is given for records without them");
  // A column of times that is misspelt is told so by column() below.
  if (!sampled && !csv.has(column::time_s) && csv.has(input_column) &&
      !nearest_word(column::time_s, csv.names()))
    throw InputError(
        csv.file(), csv.header_line(),
        fmt::format("has no column '{}', found: {}; samples without times need their sampling rate",
                    column::time_s, join(csv.names(), ", ")));
  formats::Words aside;
  const std::vector<double> time =
      sampled ? formats::sampled_times(*sample_hz, csv.rows(), aside) : csv.column(column::time_s);
  // Other programs' files call nothing a reference: their first signal is it.
  if (csv.foreign()) input_column = column::input;
  record.u = csv.column(input_column);
  if (csv.has(column::output) && input_column != column::output) record.y = csv.column(column::output);
  if (time.size() < 2) csv.fail(0, "is the only row, expected at least two samples");
  record.start_s = time.front();
  // Printed times are rounded; the mean step is the sharper figure.
  record.step_s = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  if (all_steps_near(time, record.step_s)) return record;
  // The median step is the step: one gap must not move it.
  std::vector<double> steps(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) steps[i - 1] = time[i] - time[i - 1];
  const double usual = median(std::move(steps));
  if (!(usual > 0.0)) csv.fail(1, "time_s does not rise, expected uniform sampling");
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double step = time[i] - time[i - 1];
    if (!(std::abs(step - usual) <= 0.01 * usual)) {
      csv.fail(i, fmt::format("time_s steps by {:.6g} s, expected {:.6g} s within 1 % (uniform sampling)",
                              step, usual));
    }
  }
  return record;
}

}  // namespace

TimeRecord TimeRecord::read_csv(const std::filesystem::path& path, Provenance& from, bool output_needed) {
  const Csv csv = Csv::read(path, from, formats::Content::record);
  if (output_needed) csv.column(column::output);
  return from_csv(csv, column::input, from.sample_hz);
}

TimeRecord TimeRecord::read_csv_column(const std::filesystem::path& path, Provenance& from,
                                       std::string_view input_column) {
  return from_csv(Csv::read(path, from, formats::Content::record), input_column, from.sample_hz);
}

void TimeRecord::require_measured_sizes() const {
  constexpr double kSmallest = 1e-50;
  constexpr double kLargest = 1e50;
  const auto require = [&](const std::vector<double>& signal, std::string_view name) {
    double size = 0.0;
    for (const double v : signal) size = std::max(size, std::abs(v));
    if (size == 0.0 || (size >= kSmallest && size <= kLargest)) return;
    throw InputError(file, 0,
                     fmt::format("{} reaches {}, expected {} to {}: state it in another unit", name,
                                 rounded_text(size, 3), kSmallest, kLargest));
  };
  require(u, "u");
  require(y, "y");
}

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

std::vector<double> TimeRecord::times_s() const {
  std::vector<double> out(size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = time_s(i);
  return out;
}

std::vector<double> later_by(const std::vector<double>& v, double samples) {
  std::vector<double> out(v.size());
  const double last = static_cast<double>(v.size() - 1);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double at = std::clamp(static_cast<double>(i) - samples, 0.0, last);
    const auto k = static_cast<std::size_t>(at);
    const double fraction = at - static_cast<double>(k);
    out[i] = fraction == 0.0 ? v[k] : v[k] + fraction * (v[k + 1] - v[k]);
  }
  return out;
}

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
