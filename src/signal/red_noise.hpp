#pragma once

#include <span>
#include <vector>

namespace bodesmith {

/// Noise that forgets itself exponentially, and white noise on top: y(t) = x(t) + v(t), x(t+1) = rho x(t) + w(t).
struct RedNoise {
  double correlation_samples = 1.0;  ///< 1/(1 - rho)
  double white_share = 0.0;          ///< of the power: var v / (var v + var x)
  /// Of the series under this noise (of Gaussian v and w), sizes and rho the most likely ones; infinite when all is 0.
  double log_likelihood = 0.0;
  double driving_variance = 0.0;  ///< of w
};

/// The most likely such noise that several series, each from its own beginning, have in common: their exact likelihood by the
/// Kalman filter (Harvey, Forecasting, Structural Time Series Models and the Kalman Filter, 1989, eq. 3.4.5), so that neither
/// the ends of a series nor a correlation longer than it is feign anything, as they do in a spectrum.
/// The correlation is at most `of_longest` times the longest series.
RedNoise most_likely_red_noise(const std::vector<std::span<const double>>& series, double of_longest = 8.0);

/// A series through the filter that makes this noise white and of variance 1 (the same filter's innovations): what a change of the
/// series is worth under the noise. Replaces it.
void whiten(std::span<double> series, const RedNoise& noise);

}  // namespace bodesmith
