#pragma once

#include <filesystem>
#include <string>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "synthesis/controller/controller.hpp"

namespace bodesmith::controller {

/// The description: form, parts, op-amps, multipliers, contacts, references, gain curve, loop. Without header.
Json to_json(const AnalogController& controller);

/// controller.sub, parts.csv, controller.svg, the KiCad project and controller.json (`json`: what to_json() gives, with header and whatever is known
/// of the design as built) below `folder`.
void add_controller_files(const AnalogController& controller, const std::string& title, const Json& json,
                          OutputSet& out, const std::filesystem::path& folder = "controller");

}  // namespace bodesmith::controller
