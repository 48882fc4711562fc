#pragma once

#include <string>

namespace bodesmith::report {

/// Colour `index` of the palette as #rrggbb: eight hues told apart by colour-blind readers too (Okabe and Ito).
std::string palette_colour(int index);

/// & < > " escaped.
std::string escape_xml(const std::string& text);

}  // namespace bodesmith::report
