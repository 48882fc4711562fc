#pragma once

#include <filesystem>
#include <vector>

#include "base/provenance.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith::gap {

/// A measured frequency response with what may be known of how it was taken.
struct MeasuredResponse : FrequencyRecord {
  std::vector<double> averages;  ///< empty, or over how many measurements the coherence was taken, a row
  std::vector<double> drive_v;   ///< empty, or the input's amplitude in each row

  MeasuredResponse() = default;
  explicit(false) MeasuredResponse(FrequencyRecord record) : FrequencyRecord(std::move(record)) {}

  /// As FrequencyRecord::read_csv, with the optional columns `averages` (1 or more) and `drive_v` (above 0).
  static MeasuredResponse read_csv(const std::filesystem::path& path, Provenance& from);

  /// Every `stride`-th point from number `first` on, with all of its columns.
  MeasuredResponse thinned(std::size_t first, std::size_t stride) const;
};

}  // namespace bodesmith::gap
