#pragma once

#include <filesystem>
#include <string>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "synthesis/controller/library.hpp"

namespace bodesmith::generator {

/// The description: form, parts, op-amps, multipliers, contacts, references, gain curve, loop. Without header.
Json controller_json(const DisturbanceCircuit& controller);

/// controller.sub, parts.csv, controller.svg, the KiCad project and controller.json (`json`: what controller_json() gives, with header and whatever is known
/// of the design as built) below `folder`.
void add_controller_files(const DisturbanceCircuit& controller, const std::string& title, const Json& json,
                          OutputSet& out, const std::filesystem::path& folder = "controller");

}  // namespace bodesmith::generator
