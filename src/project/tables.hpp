#pragma once

#include <filesystem>
#include <string_view>

#include "base/documents/document.hpp"
#include "project/project.hpp"

/// Tables of project.toml that projects with and without a disturbance share.
namespace bodesmith::project {

/// A file that the project names, which must exist: the error names the project's line.
std::filesystem::path file_at(const Node& table, std::string_view key, const std::filesystem::path& folder);
Project::Approximate read_approximate(const Node& node);
Project::Fpaa read_fpaa(const Node& node);
Project::Circuit read_circuit(const Node& node);
/// `tolerances`: yield_db is known.
Project::Limits read_limits(const Node& node, bool tolerances);

}  // namespace bodesmith::project
