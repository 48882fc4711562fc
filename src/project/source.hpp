#pragma once

#include <filesystem>

#include "base/documents/document.hpp"
#include "base/progress.hpp"
#include "base/provenance.hpp"

namespace bodesmith::project {

/// A project file as it was read, before anything is made of it: a sweep changes it in between.
struct ProjectSource {
  std::filesystem::path file;
  Node document;
  Provenance from;
  Deadline deadline{};  ///< of the run, see Project::deadline

  /// Throws InputError (file and line) for what is no project.
  static ProjectSource read(const std::filesystem::path& file);

  /// Whether it has no disturbance: a response to build and nothing to track (FilterProject).
  bool is_filter() const;
};

}  // namespace bodesmith::project
