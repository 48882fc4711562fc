#pragma once

#include <cstddef>
#include <string_view>

namespace bodesmith::simulate {

/// A clock of more edges than this in one record (some seconds of computing) is a slip of the pen.
inline constexpr double kMostEdges = 1e8;
/// Steps of an adaptive solver after which a record is given up: minutes.
inline constexpr std::size_t kMostSolverSteps = 50'000'000;

/// InputError naming `what` (the clock and its value) when there would be more.
void require_few_edges(double edges, std::string_view what, double most = kMostEdges);

}  // namespace bodesmith::simulate
