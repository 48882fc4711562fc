#include <cmath>
#include <span>
#include <vector>

#include "gap/signs/signs.hpp"
#include "signal/red_noise.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Gain of the logarithm of the likelihood. Of two values that are chance it is 1 on the average, and 18 once in fifty million times.
constexpr double kSurelyALine = 18.0;

double log_likelihood(const std::vector<double>& v) {
  return most_likely_red_noise({std::span<const double>(v)}).log_likelihood;
}

}  // namespace

Sign straight_line(const Leftover& record) {
  const double gain = log_likelihood(less_straight_line(record.residual)) - log_likelihood(record.residual);
  return {SignKind::straight_line, std::isfinite(gain) ? gain / kSurelyALine : 0.0};
}

}  // namespace bodesmith::gap
