#include "report/svg.hpp"

#include <array>
#include <cstddef>

namespace bodesmith::report {

std::string palette_colour(int index) {
  static constexpr std::array<const char*, kPaletteColours> kPalette = {
      "#0072b2", "#d55e00", "#008765", "#b8578c", "#2a8fc9", "#8a7a00", "#4d4d4d", "#8c564b"};
  return kPalette[static_cast<std::size_t>(index) % kPalette.size()];
}

std::string escape_xml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace bodesmith::report
