#include "signal/bode_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith {

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
  std::stable_sort(out.points.begin(), out.points.end(),
                   [](const BodePoint& a, const BodePoint& b) { return a.frequency < b.frequency; });
  for (std::size_t i = 1; i < out.points.size(); ++i) {
    if (out.points[i].frequency == out.points[i - 1].frequency) {
      throw InputError(out.file, std::max(out.points[i].line, out.points[i - 1].line),
                       fmt::format("{} Hz is given twice", out.points[i].frequency.value));
    }
  }
  return out;
}

}  // namespace bodesmith
