#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::ngspice {

/// ngspice is a circuit simulator with a command language inside: a `.control` section of any file that it reads may
/// run a shell. What comes from a user's file may therefore describe a circuit and nothing else.
///
/// InputError naming file and line when `text` has a control section, a command in a comment (`*# …`), begins as a script
/// (`*ng_script`), or has a code model that starts another program or loads a library; the same for every file that it
/// includes, however deep.
void require_plain_netlist(std::string_view text, const std::filesystem::path& file);

/// The same of a text that comes from no file, `what` for its name: it may include none.
void require_plain_text(std::string_view text, const std::string& what);

/// The same without a look at what it includes: for decks made from parts that were looked at.
void require_no_commands(std::string_view text, const std::string& what);

/// Whether a netlist's line (its continuation lines joined) would begin a control section: any word that begins with
/// `.control` does, whatever blanks stand between.
bool begins_control(std::string_view line);

/// InputError unless a node's name holds only what cannot mean anything else in a command.
void require_plain_node(const std::string& node, const std::string& what);

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

}  // namespace bodesmith::ngspice
