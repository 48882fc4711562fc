#pragma once

#include <filesystem>

#include "base/documents/document.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

/// [track]: `waveform` and `amplitude` are one value or a list.
Project::Track read_track(const Node& node);

/// InputError at [track] amplitude when the drive for it leaves the amplifier's range, `node` the whole project.
void check_drive(const Project& project, const Node& node);

/// InputError at the disturbance's own line when a generator fed by its own drive cannot settle: K |d'| of a branch
/// reaches 1 at some frequency of its table. `folder` is the project's.
void check_loop(const Project& project, const Node& node, const std::filesystem::path& folder);

}  // namespace bodesmith::project
