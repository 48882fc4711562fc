#pragma once

#include <complex>
#include <vector>

#include "signal/frequency_record.hpp"

namespace bodesmith {

/// Standard deviations (of |error|, both components together) of the points of a measured response: how far each lies
/// from the straight line through its neighbours (in ln frequency), as a running median, never below 1e-7 of the
/// magnitude. With a coherence gamma^2 the relative deviation is at least sqrt((1 - gamma^2)/(2 gamma^2)) (J. S. Bendat,
/// A. G. Piersol, "Random Data", eq. 9.90, one average). Coarse sampling of a curved response counts as noise here;
/// noise_from_errors() corrects it once there is a model.
std::vector<double> noise_from_neighbours(const FrequencyRecord& record);

/// The same from a model's errors: variance = (a + b |H|^2) c, a and b by least squares, c slowly varying.
std::vector<double> noise_from_errors(const std::vector<std::complex<double>>& errors,
                                      const std::vector<std::complex<double>>& response);

}  // namespace bodesmith
