#pragma once

#include <cstddef>
#include <vector>

namespace bodesmith::gap {

double mean(const std::vector<double>& v);
double rms(const std::vector<double>& v);
double median(std::vector<double> v);
/// The value below which the fraction q of v lies.
double quantile(std::vector<double> v, double q);

/// Samples over which v forgets itself: 1 + 2 sum of the autocorrelation up to its first crossing of 0.05.
/// n / correlation_time(v) is the effective sample size of its mean.
double correlation_time(const std::vector<double>& v);

/// Mean of v divided by its standard error, the error from the spread of block means (block bootstrap's
/// second moment): blocks are several correlation times long, so colour does not feign significance.
double block_z(const std::vector<double>& v);

}  // namespace bodesmith::gap
