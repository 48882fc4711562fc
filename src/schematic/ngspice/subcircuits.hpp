#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::spice {

/// A subcircuit as found in a library text: its name and pins.
struct Subcircuit {
  std::string name;
  std::vector<std::string> pins;
  int line = 0;
};
/// Every top-level .subckt of a library. Throws InputError with file and line when one is not ended.
std::vector<Subcircuit> list_subcircuits(const std::string& text, const std::string& file);

/// The name of the one with two pins (`in out`): `wanted`, or when that is empty "compensator" when there is
/// one, otherwise the last. Throws InputError when there is none.
std::string pick_subcircuit(const std::vector<Subcircuit>& all, const std::string& wanted,
                            const std::string& file);

/// A line by which ngspice reads another file: `.include FILE` (any word that begins with `.inc`) or `.lib FILE SECTION`.
struct IncludeLine {
  std::string file;
  std::string section;   ///< of a library; empty when it names none
  bool library = false;  ///< of .lib: without a section it may begin one itself instead of naming a file
};

/// Nothing for any other line.
std::optional<IncludeLine> include_line(std::string_view line);

/// The file that a line of `netlist` includes. Netlists come from strangers, and what ngspice cannot read it quotes: a name
/// is relative to the netlist's folder and stays in it or below (a link there may lead elsewhere). InputError naming file
/// and line for absolute names, "..", "~", and what is not there.
std::filesystem::path included_file(const IncludeLine& include, const std::filesystem::path& netlist,
                                    int line);

}  // namespace bodesmith::spice
