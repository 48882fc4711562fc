#pragma once

#include <functional>
#include <vector>

#include "base/units.hpp"

namespace bodesmith {

struct Band {
  Hertz from;
  Hertz to;
};

/// `count` frequencies, evenly spaced in log frequency, both ends included. Throws InputError unless
/// 0 < from <= to and count >= 2 (or 1 with from == to).
std::vector<Hertz> log_grid(Band band, int count);

/// Even points of a judge's own grid.
inline constexpr int kJudgedPoints = 121;

/// Frequencies at which errors of a response are looked for: `count` ones even in log frequency, and between these as many
/// as it takes until the response changes by at most `most_change` (in parts of the larger one) from one to the next (between
/// points as near as the usual ones an error's peak is met within a part in a hundred); where it
/// turns fast, at a resonance or near a notch, its errors are largest and narrowest. Below kJudgedFloor of the largest
/// magnitude seen nothing is added, nor more than 2^kDeepest points between two of the even ones.
std::vector<Hertz> judging_grid(const std::function<Complex(Hertz)>& response, Band band, int count,
                                double most_change = 0.15);

/// A response is judged where it has at least this share of its largest magnitude (-60 dB): near a zero on the axis (a
/// notch, the stop band of an elliptic filter) a ratio has no bound, and a millivolt of a volt is where an op-amp's noise and
/// what parts let through begin to rule. compare_responses() and the yield leave out what is below.
inline constexpr double kJudgedFloor = 1e-3;

}  // namespace bodesmith
