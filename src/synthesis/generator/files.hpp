#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/circuit.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::generator {

/// layout.json without its header.
Json to_json(const DisturbanceCircuit& layout);
/// The same with its parts "budget" and, where there is a switch, "timing".
Json to_json(const DisturbanceCircuit& layout, const Budget& budget, const Timing& timing);

/// `.subckt disturbance x branch out`, with amplitude gains `.subckt disturbance_amplitude x branch amplitude out`; more than two
/// branches have their select lines after `branch`. Next to it, when there is a switch, `.subckt slope_detector x branch`. `errors`:
/// every multiplier off by these limits (for checks).
std::string disturbance_library(const DisturbanceCircuit& layout, const std::string& title,
                                bool multipliers_are_off = false);

/// Its top subcircuit, and its pins: `x branch out`, or with select lines and amplitude.
std::string disturbance_name(const DisturbanceCircuit& layout);
std::string disturbance_pins(const DisturbanceCircuit& layout);

/// disturbance.sub and, with amplitude gains, disturbance_amplitude.sub.
void add_libraries(const DisturbanceCircuit& layout, const std::string& title, OutputSet& out,
                   const std::filesystem::path& folder = {});
/// The generator and the slope detector as one sheet.
std::string layout_svg(const DisturbanceCircuit& layout, const std::string& title = "Disturbance generator");
/// layout.json (`json`), both netlists, parts.csv, layout.svg and, for up to two branches, the KiCad project.
void add_layout_files(const DisturbanceCircuit& layout, const std::string& title, const Json& json,
                      OutputSet& out);

}  // namespace bodesmith::generator
