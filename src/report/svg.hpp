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

/// A drawing to stand in a page next to others: its style rules hold inside it alone, and its ids are its own. The rules
/// of a `<style>` within an `<svg>` would otherwise hold for the whole page, and the first of two equal ids for both.
/// `name` becomes the drawing's id. A drawing without a `<style>` and without ids stays as it is.
std::string inlined_svg(const std::string& svg, const std::string& name);

}  // namespace bodesmith::report
