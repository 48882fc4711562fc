#pragma once

#include <string>
#include <vector>

#include "call.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::python {

/// realization, series, capacitor_series.
synthesis::RealiseOptions circuit_options(const Node& options);
/// The sections without their delay, which no hardware of poles and zeros makes; says so in a warning.
Sections rational_part(Sections sections, std::vector<std::string>& warnings);

}  // namespace bodesmith::python
