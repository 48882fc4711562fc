#pragma once

#include <functional>
#include <vector>

#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "lti/steep_flanks.hpp"

namespace bodesmith {

using Responses = std::function<std::vector<Complex>(const std::vector<Hertz>&)>;

/// One frequency after the other.
Responses at_each(std::function<Complex(RadPerSecond)> response);

/// Frequencies halfway (in log) on both sides of every peak of a curve that comes within a tenth of its largest value.
std::vector<Hertz> around_peaks(const std::vector<Hertz>& grid, const std::vector<double>& curve);

/// Rounds of around_peaks() after which a maximum is met within a part in ten thousand.
inline constexpr int kPeakRounds = 6;

/// The largest value of a curve, from one on a grid that is made finer near its peaks.
double refined_maximum(std::vector<Hertz> grid, const std::function<double(Hertz)>& curve);

/// A judging_grid() that is made finer at the peaks of the difference until these stay.
std::vector<Hertz> judged_frequencies(const Responses& got, const Responses& wanted, Band band);

/// The largest differences over the band, between the points of any grid: compare_responses() at
/// judged_frequencies(). What every command states of a band is found here.
ResponseDifference judge_responses(const Responses& got, const Responses& wanted, Band band);

}  // namespace bodesmith
