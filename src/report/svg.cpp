#include "report/svg.hpp"

#include <array>
#include <cstddef>

namespace bodesmith::report {

std::string palette_colour(int index) {
  static constexpr std::array<const char*, 8> kPalette = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                          "#56b4e9", "#e69f00", "#4d4d4d", "#8c564b"};
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
