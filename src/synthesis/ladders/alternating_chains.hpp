#pragma once

#include <vector>

namespace bodesmith::synthesis {

/// Poles and zeros that alternate, made by one inverting op-amp with one RC ladder and one resistor.
struct AlternatingChain {
  bool lag = true;                   ///< a pole first: the ladder is the feedback, otherwise the input
  std::vector<double> poles, zeros;  ///< rad/s, rising, as many of each
};

/// The fewest-first grouping of real poles and zeros (given as positive corner frequencies, as many of each)
/// into alternating chains: every corner goes to the chain that was extended last and ends with one of the
/// other kind.
std::vector<AlternatingChain> alternating_chains(const std::vector<double>& poles,
                                                 const std::vector<double>& zeros);

}  // namespace bodesmith::synthesis
