#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "lti/bulk_response.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::cli {

/// Something with a frequency response, whatever file it came from.
struct ResponseSource {
  std::string stem;
  std::optional<Band> band;            ///< where it is interesting (its corners, or a record's range)
  std::vector<Hertz> own_frequencies;  ///< a measured record's own grid; empty for everything else
  /// NaN: a value that the file does not have; no phases: it has none at all. InputError where what is computed leaves double
  /// precision.
  std::function<LevelAndPhase(const std::vector<Hertz>&)> on_grid;
  /// The same as complex numbers; empty for what is measured.
  std::function<std::vector<Complex>(const std::vector<Hertz>&)> response;
  std::optional<Sections> sections;  ///< where the file holds sections
  bool quick = false;                ///< `response` costs little at a single frequency
};

struct ResponseOptions {
  bool as_it_runs =
      true;  ///< FPAA plans: as their switches make them; otherwise the CAMs' transfer functions alone
  std::string subcircuit;  ///< .sub files: which one; empty: the obvious one
};

/// cascade.json, sections.json, circuit.json, controller.toml, plan.json, model.toml by their schema, .sub/.cir/.lib by their ending (through ngspice, else solved here);
/// everything else is measured or simulated (docs/formats.md), by its content. InputError for anything else.
/// This program's own documents and netlists; everything else is measured or simulated data.
bool is_design(const std::filesystem::path& path);
bool is_netlist(const std::filesystem::path& path);
/// One of the elements that schematic::read_spice() knows, its top from its first pin to its second.
schematic::Netlist read_netlist(const std::filesystem::path& path, Provenance& from);
/// This program's own documents alone.
bool is_own_document(const std::filesystem::path& path);
ResponseSource load_response(const std::filesystem::path& path, const ResponseOptions& options,
                             Provenance& from);

}  // namespace bodesmith::cli
