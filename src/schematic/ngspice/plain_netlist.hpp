#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bodesmith::spice {

/// ngspice is a circuit simulator with a command language inside: a `.control` section of any file that it reads may
/// run a shell. What comes from a user's file may therefore describe a circuit and nothing else.
///
/// InputError naming file and line when `text` has a control section, a command in a comment (`*# …`), begins as a script
/// (`*ng_script`), or has a code model that starts another program or loads a library; the same for every file that it
/// includes, however deep. Where these may stand: include_line.hpp.
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

}  // namespace bodesmith::spice
