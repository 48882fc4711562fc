#pragma once

#include <optional>
#include <span>

#include "chain/block.hpp"

namespace bodesmith::chain {

/// The poles of a section N(s)/P(s), P(0) = 1, whose op-amp has a finite gain-bandwidth f: P + s D/(2 pi f), with
/// D = d0 + d1 s/w + d2 (s/w)^2 the numerator of its noise gain 1/beta = D/P and w the section's corner
/// (PartChange::noise_gain); of several op-amps of one f the sum of their D, to the first order of 1/f.
struct OpampPoles {
  double natural_frequency_hz = 0.0;  ///< of two of them, real ones too; 0: a gain has the last one alone
  double damping_ratio = 0.0;
  std::optional<Hertz> last;  ///< of a gain, and behind sections of two poles
};
/// `per_hz`: 1/f. Finite for per_hz > 0 and d2 > 0 (two poles), d1 > 0 (one), d0 > 0 (none).
OpampPoles opamp_poles(const Block& section, std::span<const double> noise_gain, double per_hz);

/// A biquad with an op-amp that something passes without (PartChange::feedthrough): the third pole, and zero where there is one,
/// make the block behind it. Not valid where that zero is not real or in the right half-plane.
struct SlowSection {
  Block section;
  Block behind;  ///< lowpass or pole_zero
};
SlowSection slow_section(const Block& section, const PartChange& opamp, double per_hz);

/// The parameter that holds a section's corner; empty: a gain.
std::string_view corner_of(const Block& section);

}  // namespace bodesmith::chain
