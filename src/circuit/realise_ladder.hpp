#pragma once

#include "circuit/rc_ladder.hpp"
#include "circuit/realise.hpp"

namespace bodesmith::circuit {

/// Poles and zeros that alternate, made by one inverting op-amp with one RC ladder and one resistor.
struct LadderChain {
  bool lag = true;                   ///< a pole first: the ladder is the feedback, otherwise the input
  std::vector<double> poles, zeros;  ///< rad/s, rising, as many of each
};

/// The fewest-first grouping of real poles and zeros (given as positive corner frequencies) into alternating
/// chains: every corner goes to the chain that was extended last and ends with one of the other kind.
std::vector<LadderChain> alternating_chains(std::vector<double> poles, std::vector<double> zeros);

/// 100 ohm to 10 Mohm, 47 pF to 4.7 uF: the values of a ladder spread as wide as its corners do.
void set_ladder_limits(RealiseOptions& options);

/// Sections as RC ladders around inverting op-amps, as fractional elements are built: for poles and zeros
/// that alternate, starting with a pole, H or, starting with a zero, 1/H is an RC impedance Z
/// (rc_ladder.hpp), so
///   lag:  H = -Z(s)/R1 with Z in the feedback,   lead: H = -R2/Z(s) with Z at the input.
/// A whole fractional term (or s^-alpha) becomes one op-amp. The gain is spread over the chains. The level of
/// each ladder is put between the limits of the parts; its values are then searched jointly (exchange of
/// single values and of pairs among their neighbours in the series, from the best levels) for the least
/// |H/H_wanted - 1|. Throws DesignError where poles or zeros are complex, right of or on the axis, or not as
/// many of one as of the other, and where no level puts all parts between their limits.
Realised realise_ladders(const Sections& sections, LadderForm form, const RealiseOptions& options);

}  // namespace bodesmith::circuit
