#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::simulate {

/// References for simulation and experiment, sampled evenly from t = 0 to duration_s. Values run from offset
/// - amplitude to offset + amplitude unless said otherwise.
struct ReferenceSpec {
  std::string kind = "triangle";  ///< a name of reference_kinds()
  Hertz frequency{1.0};           ///< of a period; of the start of a chirp; of the lowest line of a multisine
  Hertz last{100.0};              ///< chirp: the end; multisine: the highest line
  double amplitude = 0.5;
  double offset = 0.5;
  double duration_s = 1.0;
  double step_s = 1e-3;
  int steps = 10;          ///< stair: levels a rise
  std::uint64_t seed = 1;  ///< multisine
};

struct ReferenceKind {
  std::string name;
  std::string what;
};
/// triangle: from the lowest value up, corners on the samples only where the period allows it. sine: the same
/// phase, from the lowest value up. stair: the triangle held on `steps` equal levels up and down. multisine:
/// odd lines frequency, 3 frequency, ... up to `last` with random phases, scaled to the amplitude's peak.
/// chirp: from `frequency` to `last`, logarithmic, over the duration. complex: the disturbance paper's u =
/// 0.415 + 0.23 (sin 2 pi t + 0.3 sin pi t + 0.5 sin 0.2 pi t), as printed; amplitude and offset do not
/// apply.
const std::vector<ReferenceKind>& reference_kinds();
/// Its own name: "steps" are a stair.
std::string reference_kind(const std::string& name);

/// InputError for an unknown kind, a step or duration that is not above 0, a frequency the step cannot show
/// (above half the sampling rate), more than 5e7 samples.
TimeRecord make_reference(const ReferenceSpec& spec);

/// Whether every period of a reference of this kind is the same, and as long as its frequency says (a sweep
/// asks).
bool can_be_swept(const std::string& kind);

/// The frequency at which the reference repeats; absent for a chirp.
std::optional<Hertz> fundamental_of(const ReferenceSpec& spec);

}  // namespace bodesmith::simulate
