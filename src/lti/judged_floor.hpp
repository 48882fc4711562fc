#pragma once

namespace bodesmith {

/// A response is judged where it has at least this share of its largest magnitude (-60 dB): near a zero on the axis (a
/// notch, the stop band of an elliptic filter) a ratio has no bound, and a millivolt of a volt is where an op-amp's noise and
/// what parts let through begin to rule. compare_responses() and the yield leave out what is below.
inline constexpr double kJudgedFloor = 1e-3;

}  // namespace bodesmith
