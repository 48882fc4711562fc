#pragma once

#include <optional>
#include <vector>

#include "synthesis/parts/series.hpp"

namespace bodesmith::synthesis {

/// Of the weights of sums.
inline constexpr double kLeastOhm = 1e3, kGreatestOhm = 10e6;

/// The resistor that makes `gain` with this feedback, feedback/|gain|; beyond the greatest that or none (0), whichever is
/// nearer. Nothing below the least, and where a term of `volts` then misses by more than the offset of a multiplier's input.
std::optional<double> weight_for(double gain, double feedback, double volts);

/// Resistors of a summing op-amp: out = sum_k g_k v_k with g of both signs.
struct SummingResistors {
  double feedback = 0.0;
  std::vector<double> weights;  ///< 0: no such term
  double balance = 0.0;         ///< 0: none
  bool balance_at_plus = true;
};

struct SummingDesign {
  SummingResistors exact;
  SummingResistors realised;
  std::vector<double> gains;  ///< of the realised resistors
};

/// Gains that resistors make with an ideal op-amp: at the inverting input -Rf/Rk, at the other
/// (Gk/sum G+)(1 + sum G-/Gf).
std::vector<double> summing_gains(const SummingResistors& resistors, const std::vector<double>& wanted_signs);

/// Searches feedback, weights and balance jointly in the series so that the greatest |sum (g_k - wanted_k)
/// x^k| over x in [0, 1] is least. `scale[k]` is what term k's node carries at x = 1. Throws DesignError.
SummingDesign search_summing_resistors(const std::vector<double>& wanted, const std::vector<double>& scale,
                                       const Series& series);

/// Resistors of an inverting sum for any voltages.
struct SumDesign {
  double feedback = 0.0;
  std::vector<double> wanted, realised;  ///< weights, ohm; 0: the term counts for nothing and is left out
  std::vector<double> gains;             ///< that the realised resistors make
};

/// For gains below 0. `rows`: for each point that counts, the voltages of the terms and, last, what the sum should be. Feedback and weights are
/// exchanged for their neighbours in the series while the greatest error over the rows falls; terms that never exceed
/// `least_v` at the output are left out. Throws DesignError, in which `what` names the sum.
SumDesign search_sum(const std::vector<double>& gains, const std::vector<std::vector<double>>& rows,
                     const Series& series, double least_v, const std::string& what);

}  // namespace bodesmith::synthesis
