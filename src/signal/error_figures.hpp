#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

namespace bodesmith {

/// How far a computed output is from a wanted or measured one (disturbance paper, eq. 8). Every command's
/// percentages are these: of the range of the measured or wanted signal, its highest value less its lowest, over
/// the samples that are counted.
struct ErrorFigures {
  double rms = 0.0;
  double max = 0.0;
  double range = 0.0;
  double rms_percent = 0.0;
  double max_percent = 0.0;
  /// RMS with every record's own mean error taken out: a sensor's zero that moves between records is not the
  /// model's.
  double rms_free_offset = 0.0;
};
/// The definition in words, for outputs.
inline constexpr std::string_view kPercentOfRange =
    "of the measured or reference signal's range (highest less lowest) over the samples counted";

/// All samples of several records together, the range of all of them.
class ErrorSum {
 public:
  /// From sample `first` on; both of one length.
  void add(std::span<const double> got, std::span<const double> reference, std::size_t first = 0);
  ErrorFigures figures() const;

 private:
  double squares_ = 0.0;
  double max_ = 0.0;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
  double around_means_ = 0.0;
  std::size_t count_ = 0;
};

/// Of one record, from sample `first` on.
ErrorFigures error_figures(std::span<const double> got, std::span<const double> reference,
                           std::size_t first = 0);

}  // namespace bodesmith
