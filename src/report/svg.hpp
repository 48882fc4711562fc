#pragma once

#include <cstddef>
#include <string>

namespace bodesmith::report {

inline constexpr std::size_t kPaletteColours = 8;

/// Colour `index` of the palette as #rrggbb: the hues of Okabe and Ito, which colour-blind readers tell apart too, each dark
/// enough for a contrast of 3 to 1 on white.
std::string palette_colour(int index);

/// & < > " escaped.
std::string escape_xml(const std::string& text);

}  // namespace bodesmith::report
