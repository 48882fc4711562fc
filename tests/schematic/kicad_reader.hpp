#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace bodesmith {

/// A KiCad 6 schematic as KiCad understands it, read by this test's own means: s-expressions, pins of the
/// embedded symbols turned and mirrored to their places, wires, junctions, labels and sheet pins resolved to
/// nets by where they are.
struct KicadSchematic {
  struct Component {
    std::string value, footprint;
    std::map<std::string, std::string> fields;
    std::map<std::string, int> pin_nets;  ///< pin number to net
  };
  std::map<std::string, Component> components;  ///< by reference; supplies and flags left out
  std::map<int, std::set<std::string>> names;   ///< of a net: labels ("/" in front in a sub-sheet), supplies
  int dangling_ends = 0;                        ///< ends of wires where nothing else is
  int stacked_texts = 0;                        ///< references or values of two parts at one place
  int overlaps = 0;                             ///< pairs of parts' bodies one upon the other
  bool off_page = false;
  int sheets = 0;
};

/// What a schematic has to show, read from elsewhere.
struct KicadNetlist {
  struct Element {
    std::vector<std::string> nodes;  ///< of an op-amp: plus, minus, out
    double value = 0.0;
  };
  std::map<std::string, Element> parts;   ///< R… and C…
  std::map<std::string, Element> opamps;  ///< without the leading X
};

/// bom.csv: the drawing's reference by the netlist's name. Each line's quantity is held against its references.
std::map<std::string, std::string> read_references(const std::string& path);

/// Throws std::runtime_error for what KiCad would not load.
KicadSchematic read_kicad(const std::string& folder, const std::string& root = "compensator.kicad_sch");

/// It joins exactly what the netlist joins, with the same parts and values, on its page, and has nothing else but what a board
/// needs. `references`: by the netlist's names.
void expect_joined(const KicadSchematic& schematic, const KicadNetlist& netlist,
                   const std::map<std::string, std::string>& references, double tolerance);

}  // namespace bodesmith
