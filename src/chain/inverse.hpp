#pragma once

#include <cstddef>
#include <vector>

#include "chain/kernel.hpp"

namespace bodesmith::chain {

/// What a block's output shall be at the samples of a record, all of it known beforehand.
struct WantedOutput {
  double start_s = 0.0;
  double step_s = 0.0;
  std::vector<double> values;
  bool preview = true;      ///< delays are made good by looking ahead; otherwise they are left
  double smoothing = 3e-4;  ///< of linear blocks, see LocalGoal: more where the wanted signal jumps
};

/// The input that gives it, from rest under the first one.
struct FoundInput {
  std::vector<double> values;
  /// Samples whose output no input gives; the nearest one is taken.
  std::vector<std::size_t> out_of_reach;
};

// Inverses that several blocks share.

/// Of a linear block: bounded also where the exact inverse is unstable or would ring between samples (two-sided, by
/// preview, a little weight on the drive's second difference).
FoundInput inverse_of(const LinearKernel& kernel, const WantedOutput& wanted);
/// Of a polynomial, on the piece between turns that reaches most of the samples (of equal ones that nearest to 0).
FoundInput inverse_of_polynomial(const std::vector<double>& coefficients, const WantedOutput& wanted);
/// Of what adds a known signal.
FoundInput inverse_of(const SourceKernel& kernel, const WantedOutput& wanted);
/// The wanted signal `lead_s` later, where looking ahead is allowed; its last value at the end.
FoundInput looking_ahead(const WantedOutput& wanted, double lead_s);
/// Of a clocked block: its gain at rest, and the mean delay of sample, hold and half cycle.
FoundInput inverse_of(SampledKernel& kernel, const WantedOutput& wanted);

/// A clocked block's gain for slow signals.
double gain_at_rest(SampledKernel& kernel);
/// The mean time by which a clocked block is late.
double mean_delay_s(const SampledKernel& kernel);

}  // namespace bodesmith::chain
