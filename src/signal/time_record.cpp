#include "signal/time_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/text.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "signal/formats/table_meaning.hpp"
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

}  // namespace bodesmith
