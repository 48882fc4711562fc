#include "gap/measured_response.hpp"

#include <fmt/format.h>

#include <string_view>

#include "signal/csv.hpp"

namespace bodesmith::gap {
namespace {

constexpr std::string_view kAverages = "averages";
constexpr std::string_view kDrive = "drive_v";

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

MeasuredResponse MeasuredResponse::read_csv(const std::filesystem::path& path, Provenance& from) {
  MeasuredResponse record(FrequencyRecord::read_csv(path, from));
  Provenance aside;  // the file is in `from` already
  const Csv csv = Csv::read(path, aside, formats::Content::response);
  record.averages = optional_column(csv, kAverages, 1.0);
  record.drive_v = optional_column(csv, kDrive, 1e-12);
  return record;
}

MeasuredResponse MeasuredResponse::thinned(std::size_t first, std::size_t stride) const {
  MeasuredResponse part;
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

}  // namespace bodesmith::gap
