#pragma once

#include <optional>
#include <string>

#include "signal/formats/number_table.hpp"

namespace bodesmith::formats {

/// Times of rows that have none, as the lines above them say.
struct Sampling {
  std::string key;  ///< as the file calls the step
  double start_s = 0.0;
  double step_s = 0.0;
};

/// "Delta_X<tab>1e-4<tab>1e-4" and "X0" (LabVIEW), "HResolution" and "HOffset" (Yokogawa), "Time interval,100uS" (Owon),
/// "XInc:,1e-4" and "XOrg:" (Infiniium). Nothing where there is no step, or where channels have different ones.
std::optional<Sampling> sampling_above(const NumberTable& table);

}  // namespace bodesmith::formats
