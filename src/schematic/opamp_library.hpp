#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/provenance.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// Op-amp types by name; "generic-10M" (this program's default) and "ideal" are always there.
class OpAmpLibrary {
 public:
  /// The list that comes with the program (templates/spice/opamps.toml).
  static OpAmpLibrary built_in();
  /// A list of the user's, `bodesmith.opamps/1`; its types come before the built-in ones.
  static OpAmpLibrary read(const std::filesystem::path& path, Provenance& from);

  const std::vector<OpAmpModel>& types() const { return types_; }
  /// Throws InputError that lists the names.
  const OpAmpModel& named(const std::string& name) const;

 private:
  void add(const Node& document);
  std::vector<OpAmpModel> types_;
};

}  // namespace bodesmith::schematic
