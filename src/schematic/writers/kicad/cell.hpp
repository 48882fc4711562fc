#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "schematic/series_parallel.hpp"
#include "schematic/writers/kicad/drawing.hpp"

namespace bodesmith::kicad {

/// Where a piece of drawing can be joined to another one: by a wire or by a label.
struct Anchor {
  Point at;
  std::string net;
  /// end: a wire that ends here and needs a name; inner: named only when other pieces use the net;
  /// output: always named.
  enum class Kind { end, inner, output } kind = Kind::end;
  /// Where the name stands, at the end of a wire straight from `at`, when there is no room at the place itself.
  std::optional<Point> name_at = std::nullopt;
};

/// One op-amp with the parts at its inputs and around it, drawn left to right; or, without an op-amp, parts
/// that belong to none. The op-amp's centre is the origin.
struct Cell {
  Drawing drawing;
  std::vector<Anchor> anchors;
  std::optional<size_t> entry;  ///< the anchor that the piece to the left may be wired to
  std::optional<size_t> exit;
};

/// The texts of a part's symbol: reference, value, footprint and fields.
using PartTexts = std::function<Symbol(const schematic::Part&)>;

/// The cells of one stage, op-amps in their order. Around every op-amp: its own feedback above (for the lower
/// input below), what leads to its inputs on the left, the parts of an inner node that also goes to the
/// output or to ground (Sallen-Key, multiple feedback) between them; every other net by its name. `named`: nodes
/// that something beyond these parts needs.
std::vector<Cell> stage_cells(const std::vector<schematic::Part>& parts,
                              const std::vector<schematic::OpAmp>& opamps, const std::string& in,
                              const std::string& out, const PartTexts& texts,
                              const std::function<Symbol(const schematic::OpAmp&)>& opamp_symbol,
                              const std::set<std::string>& named = {});

}  // namespace bodesmith::kicad
