#pragma once

#include "base/json_fwd.hpp"
#include "synthesis/opamp_check.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::circuit {

/// stages, parts, op-amp and the error of each step; without the header.
Json to_json(const Realised& realised);
/// {"max_magnitude_db", "max_phase_deg", "max_complex_percent", "worst_hz"}.
Json to_json(const ResponseDifference& difference);
/// The same with the band in which it was found: `judged` of circuit.json.
Json judged_json(const ResponseDifference& difference, Band band);
Json to_json(const OpAmpCheck& check);

}  // namespace bodesmith::circuit
