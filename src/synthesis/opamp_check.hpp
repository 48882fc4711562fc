#pragma once

#include <string>
#include <vector>

#include "lti/sections.hpp"
#include "synthesis/circuit.hpp"

namespace bodesmith::synthesis {

/// What a type of op-amp does in a circuit, in numbers.
struct OpAmpCheck {
  std::string name;
  ResponseDifference against_ideal;    ///< over the band, the whole network
  double output_offset_v = 0.0;        ///< all offsets and bias currents at their worst signs, at the output
  double min_phase_margin_deg = 90.0;  ///< of any stage, its capacitive load counted
  std::size_t tightest_stage = 0;      ///< counted from 1
  double full_swing_hz =
      0.0;  ///< highest frequency of a sine of `amplitude_v` at the highest node without slewing
  double output_current_a = 0.0;  ///< greatest of any op-amp with a sine of `amplitude_v` at the input
  std::size_t loaded_stage = 0;   ///< whose it is, counted from 1
  double highest_q = 0.0;         ///< of any stage's poles; 0 when all are real
  double noise_rms_v = 0.0;       ///< at the output, over the band
  std::vector<std::string> warnings;
};

/// Checks with `circuit.opamp`; `amplitude_v` at the input.
OpAmpCheck check_opamps(const Circuit& circuit, Band band, double amplitude_v = 1.0);

}  // namespace bodesmith::synthesis
