#pragma once

#include <string>
#include <vector>

namespace bodesmith::report {

/// Round tick positions that cover [from, to] (linear), about `count` of them: steps of 1, 2 or 5 times a power of ten.
std::vector<double> linear_ticks(double from, double to, int count);
/// Decades in [from, to]; with fewer than two decades also 2 and 5 times them.
std::vector<double> logarithmic_ticks(double from, double to);
/// 2 ... 9 times each decade within [from, to]: the fine lines between the ticks.
std::vector<double> logarithmic_subdivisions(double from, double to);

/// 0.25, 100, 1e5, 2.5e-4.
std::string tick_text(double value);
/// The same with prefixes, for axes of hertz: 0.25, 100, 20k, 1M.
std::string prefixed_tick_text(double value);

}  // namespace bodesmith::report
