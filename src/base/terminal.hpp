#pragma once

#include <string>
#include <string_view>

namespace bodesmith {

/// What the person at the terminal wants to see.
enum class Tone { error, warning, good, strong, faint };

/// Whether the stream is a terminal that a person looks at.
bool on_terminal(int file_descriptor);
/// Whether text on this stream may have colours: a terminal, TERM not "dumb", and the environment variable NO_COLOR absent or
/// empty (https://no-color.org).
bool colours_wanted(int file_descriptor);
/// `text` in a colour where the stream shows colours, otherwise as it is.
std::string coloured(std::string_view text, Tone tone, int file_descriptor);
/// Columns of the terminal; 80 where none is known.
int terminal_columns(int file_descriptor);

/// No notes, no progress; errors alone.
void be_quiet();
bool quiet();

}  // namespace bodesmith
