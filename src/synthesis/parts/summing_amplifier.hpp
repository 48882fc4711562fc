#pragma once

#include <optional>
#include <string>
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

/// Searches feedback, weights and balance jointly in the series, near the exact ones, for the least greatest error over the rows: for
/// each point that counts the voltages of the terms and, last, what the sum should be. Terms that do nothing are left out. Throws
/// DesignError, in which `what` names the sum.
SummingDesign search_sum(const std::vector<double>& gains, const std::vector<std::vector<double>>& rows,
                         const Series& series, const std::string& what);

}  // namespace bodesmith::synthesis
