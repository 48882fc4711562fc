#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace bodesmith::spice {

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
