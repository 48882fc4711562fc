#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/provenance.hpp"

namespace bodesmith {

/// A uniformly sampled record: input u and, unless it is an input only, output y.
struct TimeRecord {
  std::string file;
  double start_s = 0.0;
  double step_s = 0.0;
  std::vector<double> u;
  std::vector<double> y;  ///< empty for an input only

  std::size_t size() const { return u.size(); }
  double time_s(std::size_t i) const { return start_s + step_s * static_cast<double>(i); }
  std::vector<double> times_s() const;  ///< of all samples
  double duration_s() const { return u.empty() ? 0.0 : step_s * static_cast<double>(u.size() - 1); }

  /// CSV `time_s,u,y` (y may be absent unless `output_needed`). A gap, a step back or a jitter over 1 % of
  /// the step is an InputError that names the line, as are fewer than two rows. `u,y` alone where `from` has a sampling rate.
  static TimeRecord read_csv(const std::filesystem::path& path, Provenance& from, bool output_needed = false);
  /// The same reader for other column names, e.g. a reference `time_s,r` (the column's values land in u).
  static TimeRecord read_csv_column(const std::filesystem::path& path, Provenance& from,
                                    std::string_view input_column);

  /// InputError unless the greatest |u| and |y| are 0 or within 1e-50 to 1e50: for searches, where squares and products
  /// of four of these numbers must stay far inside a double's range.
  void require_measured_sizes() const;
};

/// A sampled signal `samples` later (below 0 earlier), which need not be whole: linear between samples, its ends continued.
std::vector<double> later_by(const std::vector<double>& v, double samples);

/// How far a signal goes: what a model fitted to it has seen.
struct SignalExtent {
  double lower = 0.0;
  double upper = 0.0;
  double max_rate_per_s = 0.0;  ///< fastest change from sample to sample
  /// The band with all but a thousandth of the signal's variance, half of that below it and half above.
  double from_hz = 0.0;
  double to_hz = 0.0;
};
/// Of u of all records together, each without its first `skip_s` seconds.
SignalExtent input_extent(std::span<const TimeRecord> records, double skip_s = 0.0);

}  // namespace bodesmith
