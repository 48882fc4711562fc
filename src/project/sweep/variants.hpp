#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "project/project.hpp"

namespace bodesmith::project {

/// One row of a table of variants: what it changes in the project.
struct Variant {
  Variant(std::string called, Node place) : name(std::move(called)), at(std::move(place)) {}

  std::string name;                               ///< of its folder, too
  Node at;                                        ///< where it stands
  std::vector<std::pair<std::string, Node>> set;  ///< dotted key of the project, its value there
  std::vector<std::pair<std::string, Node>> removed;

  /// "approximate.order = 3, hardware.fpaa removed": for tables.
  std::string what() const;
  /// The value that it gives `key`, as text; "removed", or empty where it leaves the project's own.
  std::string value_of(const std::string& key) const;
};

/// Reads a file of schema bodesmith.variants/1:
///   [[variant]]                       each a design of its own …
///   name = "small"
///   set.approximate.order = 2         any key of the project
///   remove = ["hardware.fpaa"]
///   [grid]                            … and all combinations of these values
///   "hardware.circuit.resistors" = ["E24", "E96"]
/// Throws InputError (file and line) for names that are no folders' names or stand twice, tables without a change,
/// and grids of more than 10 000 designs.
std::vector<Variant> read_variants(const std::filesystem::path& file, Provenance& from);

/// The project as the variant has it. Errors in what it says name its own file and line.
ProjectSource with_variant(const ProjectSource& project, const Variant& variant);

}  // namespace bodesmith::project
