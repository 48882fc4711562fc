#include "signal/bode_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith {
namespace {

/// Empty where there is no such column. Its values are `least` or more.
std::vector<double> optional_column(const Csv& csv, std::string_view name, double least) {
  if (!csv.has(name)) return {};
  const auto& values = csv.column(name);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= least))
      csv.fail(i, fmt::format("{} is {}, expected {:g} or more", name, values[i], least));
  }
  return values;
}

}  // namespace

BodePoints BodePoints::read_csv(const std::filesystem::path& path, Provenance& from) {
  const Csv csv = Csv::read(path, from, formats::Content::response);
  BodePoints out;
  out.file = csv.file();
  const auto& frequency = csv.column(column::frequency_hz);
  const bool linear = csv.has(column::gain);
  if (!linear && !csv.has(column::magnitude_db)) {
    throw InputError(csv.file(), csv.header_line(), "has neither a column 'gain' nor 'magnitude_db'");
  }
  const auto& magnitude = csv.column(linear ? column::gain : column::magnitude_db);
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    BodePoint point;
    point.frequency = Hertz{frequency[i]};
    if (!above_zero(frequency[i]))
      csv.fail(i, fmt::format("frequency_hz is {}, expected above {}", frequency[i],
                              frequency[i] > 0.0 ? "2.3e-308" : "0"));
    point.gain = linear ? magnitude[i] : from_decibel(magnitude[i]);
    if (!(point.gain > 0.0) || !std::isfinite(point.gain)) {
      csv.fail(i, fmt::format("the gain is {}, expected a finite number above 0", point.gain));
    }
    constexpr double kRoundingDb = 0.01;
    if (linear && csv.has(column::magnitude_db) &&
        !(std::abs(to_decibel(point.gain) - csv.column(column::magnitude_db)[i]) < kRoundingDb))
      csv.fail(i, fmt::format("its gain is {} and its magnitude_db {}, expected one of them, or the same",
                              point.gain, csv.column(column::magnitude_db)[i]));
    if (csv.has(column::phase_deg)) point.phase_deg = csv.column(column::phase_deg)[i];
    if (csv.has(column::weight)) point.weight = csv.column(column::weight)[i];
    if (point.weight < 0.0) csv.fail(i, fmt::format("weight is {}, expected at least 0", point.weight));
    point.line = csv.line(i);
    out.points.push_back(point);
  }
  std::ranges::stable_sort(out.points, {}, &BodePoint::frequency);
  for (std::size_t i = 1; i < out.points.size(); ++i) {
    if (out.points[i].frequency == out.points[i - 1].frequency) {
      throw InputError(out.file, std::max(out.points[i].line, out.points[i - 1].line),
                       fmt::format("{} Hz is given twice", out.points[i].frequency.value));
    }
  }
  return out;
}

FrequencyRecord FrequencyRecord::read_csv(const std::filesystem::path& path, Provenance& from) {
  const Csv csv = Csv::read(path, from, formats::Content::response);
  FrequencyRecord record;
  record.file = csv.file();
  const auto& frequency = csv.column(column::frequency_hz);
  const auto& magnitude = csv.column(column::magnitude_db);
  const auto& phase = csv.column(column::phase_deg);
  if (csv.has(column::coherence)) record.coherence = csv.column(column::coherence);
  record.averages = optional_column(csv, "averages", 1.0);
  record.drive_v = optional_column(csv, "drive_v", 1e-12);
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    if (!above_zero(frequency[i]))
      csv.fail(i, fmt::format("frequency_hz is {}, expected above {}", frequency[i],
                              frequency[i] > 0.0 ? "2.3e-308" : "0"));
    if (i > 0 && !(frequency[i] > frequency[i - 1])) csv.fail(i, "frequency_hz does not rise");
    if (!record.coherence.empty() && !(record.coherence[i] >= 0.0 && record.coherence[i] <= 1.0)) {
      csv.fail(i, fmt::format("coherence is {}, expected 0 to 1", record.coherence[i]));
    }
    const double gain = from_decibel(magnitude[i]);
    if (!std::isfinite(gain))
      csv.fail(i, fmt::format("magnitude_db is {}, expected at most 6000", magnitude[i]));
    record.frequency.push_back(Hertz{frequency[i]});
    record.response.push_back(std::polar(gain, to_radians(phase[i])));
  }
  return record;
}

FrequencyRecord FrequencyRecord::thinned(std::size_t first, std::size_t stride) const {
  FrequencyRecord part;
  part.file = file;
  const auto keep = [](const auto& all, std::size_t i, auto& kept) {
    if (!all.empty()) kept.push_back(all[i]);
  };
  for (std::size_t i = first; i < frequency.size(); i += stride) {
    keep(frequency, i, part.frequency);
    keep(response, i, part.response);
    keep(coherence, i, part.coherence);
    keep(averages, i, part.averages);
    keep(drive_v, i, part.drive_v);
  }
  return part;
}

}  // namespace bodesmith
