#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "fpaa/network.hpp"

namespace bodesmith::fpaa {

/// One path of a sum of partial fractions: its pole, or its two poles (complex, or real ones that lie near each
/// other).
struct ParallelPath {
  std::complex<double> pole;                   ///< rad/s
  std::optional<std::complex<double>> second;  ///< a two-op-amp path with a free numerator of first order
  bool by_ratios = false;      ///< a real pole as a two-op-amp low pass: two capacitor ratios, faster clock
  double least_divisor = 0.0;  ///< for one by ratios: no faster clock than this is needed
  bool ahead = false;          ///< reads what the last stage of `before` reads, not what comes out of it
  std::int64_t divisor = 1;
};

struct ParallelOptions {
  std::int64_t sum_divisor = 4;  ///< of the master clock, for the constant path and the sums
  int cout = 3;                  ///< units of a low pass's Cout: large ones match better and clock slower
  double lowest_clock_hz = 0.0;
  bool lead = false;       ///< every path leads in the sums: where their half period counts within the band
  std::size_t clocks = 5;  ///< different ones for the paths, at most
  /// Standard deviation of a weight, which keeps weights small that hardly act (poles near each other).
  double weight_deviation = 0.003;
};

/// The clock of each path: the highest that its capacitors allow, a multiple of the sum's period.
std::vector<ParallelPath> with_clocks(std::vector<ParallelPath> paths, const NetworkTarget& target,
                                      const ParallelOptions& options);

/// Least squares of the weights, all holds inside.
struct ParallelWeights {
  double constant = 0.0;
  std::vector<double> low;   ///< of each path: its low pass (gain at DC)
  std::vector<double> band;  ///< of each second-order path: D/(…)
  double cost = 0.0;         ///< sum of squares, those that keep the weights small included
};
ParallelWeights parallel_weights(const std::vector<ParallelPath>& paths, const Network& before,
                                 const NetworkResponse& response, const ParallelOptions& options);

/// The paths left when the least useful is taken away one after the other: element k has k + 1 paths.
std::vector<std::vector<ParallelPath>> fewer_paths(std::vector<ParallelPath> paths, const Network& before,
                                                   const NetworkResponse& response,
                                                   const ParallelOptions& options);

/// Paths whose hold at one ratio's clock costs too much (their share of the response is large above it) become
/// paths by two ratios; with_clocks() then gives them their clock. False when there are none.
/// Their clock: `clock_over` times the frequency where it costs most.
bool quicken_paths(std::vector<ParallelPath>& paths, const Network& before, const NetworkResponse& response,
                   const ParallelOptions& options, double clock_over);

/// Constant path + paths + sums behind `before` (nothing: the board's input), capacitors not yet whole.
///
/// Every stage inverts: what has to come out with a plus goes through an even number of stages. So the sums
/// are a chain, the last one (Sum1) drives the output; what needs one more inversion enters at Sum2, and so on.
Network parallel_network(const std::vector<ParallelPath>& paths, Network before,
                         const NetworkResponse& response, const ParallelOptions& options);

}  // namespace bodesmith::fpaa
