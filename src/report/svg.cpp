#include "report/svg.hpp"

#include <array>
#include <string_view>

#include "base/text.hpp"

namespace bodesmith::report {
namespace {

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

/// "#name a, #name b" of "a, b". What is said of the root element itself holds for the element of that id.
std::string scoped_selectors(std::string_view selectors, const std::string& name) {
  std::vector<std::string> out;
  for (const std::string_view one : split(selectors, ',')) {
    const std::string_view selector = trim(one);
    const bool root = selector == "svg" || selector == ":root";
    out.push_back("#" + name + (root ? std::string() : " " + std::string(selector)));
  }
  return join(out, ",");
}

/// Rules without nesting, which is all that the drawings have.
std::string scoped_rules(std::string_view rules, const std::string& name) {
  std::string out = "\n";
  while (true) {
    const std::size_t open = rules.find('{');
    const std::size_t close = rules.find('}');
    if (open == std::string_view::npos || close == std::string_view::npos) return out;
    out += scoped_selectors(rules.substr(0, open), name);
    out += rules.substr(open, close + 1 - open);
    out += '\n';
    rules.remove_prefix(close + 1);
  }
}

}  // namespace

std::string inlined_svg(const std::string& svg, const std::string& name) {
  static const std::string kOpen = "<style>";
  static const std::string kClose = "</style>";
  const std::size_t open = svg.find(kOpen);
  const std::size_t close = svg.find(kClose);
  const bool styled = open != std::string::npos && close != std::string::npos;
  if (!styled && svg.find(" id=\"") == std::string::npos) return svg;
  std::string out = svg;
  if (styled) {
    const std::size_t from = open + kOpen.size();
    out.replace(from, close - from, scoped_rules(std::string_view(svg).substr(from, close - from), name));
  }
  replace_all(out, " id=\"", " id=\"" + name + "-");
  replace_all(out, "url(#", "url(#" + name + "-");
  replace_all(out, "href=\"#", "href=\"#" + name + "-");
  const std::size_t root = out.find("<svg");
  if (root != std::string::npos) out.insert(root + 4, " id=\"" + name + "\"");
  return out;
}

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
