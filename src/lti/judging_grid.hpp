#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "lti/frequency_grid.hpp"

namespace bodesmith {

/// Even points of a judge's own grid.
inline constexpr int kJudgedPoints = 121;

/// Frequencies at which errors of a response are looked for: `count` ones even in log frequency, and between these as many
/// as it takes until the response changes by at most `most_change` (in parts of the larger one) from one to the next (between
/// points as near as the usual ones an error's peak is met within a part in a hundred); where it
/// turns fast, at a resonance or beside a notch, its errors are largest and narrowest. Below kJudgedFloor of the largest
/// magnitude seen nothing is added, nor more than 2^kDeepest points between two of the even ones.
std::vector<Hertz> judging_grid(const std::function<std::complex<double>(Hertz)>& response, Band band,
                                int count, double most_change = 0.15);

}  // namespace bodesmith
