#pragma once

#include <span>
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

/// Where the spectrum of what is left is taken from in its lowest bins, in which a slow change has already taken what
/// was there.
enum class LowBins {
  as_they_are,
  as_octaves_above,  ///< up to three times as much, where the octaves above rise towards them like a random walk's
};

/// How many standard deviations the improvement from residual `before` to residual `after` lies above what
/// chance gives. The improvement is 2 sum(before d) - sum(d^2) with d = before - after, so the question is
/// whether `before` goes along with d; by chance sum(after d) has the variance (2/N^2) sum |A(k)|^2 |D(k)|^2
/// over the bins of their spectra (A smoothed), which counts the noise's colour and how unevenly d is spread
/// over the record.
double improvement_z(const std::vector<double>& before, const std::vector<double>& after,
                     LowBins low_bins = LowBins::as_they_are);

/// Less the straight line over its places that comes nearest (least squares).
std::vector<double> less_straight_line(const std::vector<double>& v);

}  // namespace bodesmith
