#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace bodesmith {

double mean(std::span<const double> v);
double rms(std::span<const double> v);
double median(std::vector<double> v);
/// The value below which the fraction q of v lies, on the straight line between the two nearest of v (Hyndman and Fan,
/// Am. Stat. 50 (1996) 361, definition 7); 0 of none.
double quantile(std::vector<double> v, double q);
/// The same of values in rising order.
double quantile_of_sorted(std::span<const double> sorted, double q);

/// Samples over which v forgets itself: 1 + 2 sum of the autocorrelation up to its first crossing of 0.05.
/// n / correlation_time(v) is the effective sample size of its mean.
double correlation_time(std::span<const double> v);

/// Less the straight line over its places that comes nearest (least squares).
std::vector<double> less_straight_line(const std::vector<double>& v);

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
