#include <cmath>

#include <map>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "schematic/writers/kicad/devices.hpp"
#include "schematic/writers/kicad/sheet_rows.hpp"

namespace bodesmith::kicad {
namespace {

/// Outlines in mm from the symbol's place, y downwards, as in templates/spice/kicad_symbols.txt.
const char* outline_of(const Symbol& symbol, bool power_unit) {
  static const std::map<std::string, const char*> kOutlines = {
      {"R", "M-1.016 -2.54H1.016V2.54H-1.016ZM0 -3.81V-2.54M0 3.81V2.54"},
      {"C", "M-2.032 -.762H2.032M-2.032 .762H2.032M0 -3.81V-.762M0 3.81V.762"},
      {"D", "M-1.27 -1.27V1.27L1.27 0ZM1.27 -1.27V1.27M-3.81 0H-1.27M3.81 0H1.27"},
      {"OpAmp",
       "M-5.08 -5.08L5.08 0L-5.08 5.08ZM-7.62 -2.54H-5.08M-7.62 2.54H-5.08M7.62 0H5.08M-4.4 -2.54h1.4M-4.4 2.54h1.4M-3.7 "
       "1.84v1.4"},
      {"AD835",
       "M-7.62 -10.16H7.62V10.16H-7.62ZM-10.16 -5.08H-7.62M-10.16 -2.54H-7.62M-10.16 2.54H-7.62M-10.16 "
       "5.08H-7.62M-10.16 7.62H-7.62M10.16 0H7.62M0 -12.7V-10.16M0 12.7V10.16M-1.5 -1.5L1.5 1.5M-1.5 1.5L1.5 -1.5"},
      {"ADG413", "M-5.08 -2.54H5.08V5.08H-5.08ZM-7.62 0H-2L2 -1.8M2 0H7.62M-7.62 2.54H-5.08"},
      {"VoltageReference", "M-5.08 -5.08H5.08V5.08H-5.08ZM-7.62 0H-5.08M7.62 0H5.08M0 7.62V5.08"},
      {"Conn_1x02", "M-1.27 -1.27H1.27V3.81H-1.27ZM5.08 0H1.27M5.08 2.54H1.27"},
      {"Conn_1x03", "M-1.27 -3.81H1.27V3.81H-1.27ZM5.08 -2.54H1.27M5.08 0H1.27M5.08 2.54H1.27"},
      {"GND", "M0 0V1.27M-1.27 1.27H1.27L0 2.54Z"},
      {"VCC", "M0 0V-2.54M-.762 -1.27L0 -2.54L.762 -1.27"},
      {"VEE", "M0 0V2.54M-.762 1.27L0 2.54L.762 1.27"},
      {"PWR_FLAG", "M0 0V-1.27L1.016 -1.905L0 -2.54L-1.016 -1.905L0 -1.27"}};
  if (symbol.kind == "ADG413" && power_unit)
    return "M-5.08 -7.62H5.08V7.62H-5.08ZM-7.62 0H-5.08M7.62 0H5.08M0 -10.16V-7.62M0 10.16V7.62";
  if (power_unit) return "M0 -7.62V-3.81M0 7.62V3.81";
  const std::string kind = symbol.kind == "OpAmp_Dual" ? "OpAmp"
                           : symbol.kind == "V5P"      ? "VCC"
                           : symbol.kind == "V5N"      ? "VEE"
                                                       : symbol.kind;
  return kOutlines.at(kind);
}

bool is_power_unit(const Symbol& symbol) {
  if (symbol.kind == "ADG413") return symbol.unit == 5;
  return symbol.kind.starts_with("OpAmp") && symbol.pins.size() == 2;
}

Json text_json(double x, double y, const std::string& text, const char* anchor, const char* kind) {
  return {{"x", rounded_text(x, 7)},
          {"y", rounded_text(y, 7)},
          {"text", text},
          {"anchor", anchor},
          {"kind", kind}};
}

void add_symbol(const Symbol& symbol, Json& data) {
  const double x = symbol.at.x * kGridMm, y = symbol.at.y * kGridMm;
  data["symbols"].push_back({{"x", rounded_text(x, 7)},
                             {"y", rounded_text(y, 7)},
                             {"angle", -symbol.angle},
                             {"flip", symbol.mirrored ? -1 : 1},
                             {"outline", outline_of(symbol, is_power_unit(symbol))}});
  const char* const anchor = symbol.text_to_right ? "start" : "middle";
  if (!symbol.reference.empty())
    data["texts"].push_back(text_json(x + symbol.reference_mm[0], y + symbol.reference_mm[1] + 0.5,
                                      symbol.reference, anchor, "name"));
  if (!symbol.value_hidden && symbol.kind != "GND" && symbol.kind != "PWR_FLAG")
    data["texts"].push_back(
        text_json(x + symbol.value_mm[0], y + symbol.value_mm[1] + 0.5, symbol.value, anchor, "value"));
}

}  // namespace

std::string sheet_svg(const Sheet& sheet, const std::string& title) {
  const Drawing& drawing = sheet.drawing;
  Json data;
  data["title"] = title;
  const double width = (drawing.right + kMargin) * kGridMm, height = (drawing.bottom + kMargin) * kGridMm;
  data["width"] = rounded_text(width, 6);
  data["height"] = rounded_text(height, 6);
  // Its own size on a screen, in pixels of 1/96 inch.
  data["wide"] = rounded_text(std::ceil(width * 96.0 / 25.4), 6);
  data["high"] = rounded_text(std::ceil(height * 96.0 / 25.4), 6);
  for (const char* list : {"wires", "junctions", "symbols", "texts"}) data[list] = Json::array();
  const Joined joined = join_wires(drawing);
  for (const Wire& wire : joined.wires) {
    data["wires"].push_back({{"x1", rounded_text(wire.a.x * kGridMm, 7)},
                             {"y1", rounded_text(wire.a.y * kGridMm, 7)},
                             {"x2", rounded_text(wire.b.x * kGridMm, 7)},
                             {"y2", rounded_text(wire.b.y * kGridMm, 7)}});
  }
  for (const Point at : joined.junctions)
    data["junctions"].push_back(
        {{"x", rounded_text(at.x * kGridMm, 7)}, {"y", rounded_text(at.y * kGridMm, 7)}});
  for (const Symbol& symbol : drawing.symbols) add_symbol(symbol, data);
  for (const Label& label : drawing.labels)
    data["texts"].push_back(text_json(label.at.x * kGridMm + (label.to_left ? -0.3 : 0.3),
                                      label.at.y * kGridMm - 0.3, label.net, label.to_left ? "end" : "start",
                                      "net"));
  for (const Text& text : drawing.texts) {
    // Lines stand above the point, as KiCad sets them.
    const auto lines = split(text.text, '\n');
    for (size_t i = 0; i < lines.size(); ++i)
      data["texts"].push_back(text_json(text.at.x * kGridMm,
                                        text.at.y * kGridMm - 2.0 * static_cast<double>(lines.size() - 1 - i),
                                        std::string(lines[i]), "start", "head"));
  }
  return render_template("layout/sheet.svg", data);
}

}  // namespace bodesmith::kicad
