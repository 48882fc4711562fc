#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodesmith {

/// Small inputs for seeded_commands().
void write_seeded_inputs(const std::filesystem::path& folder);

/// Commands over these inputs, at least one of every subcommand; they end within a second each.
const std::vector<std::string>& seeded_commands();

}  // namespace bodesmith
