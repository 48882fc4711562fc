#include "schematic/writers/kicad/devices.hpp"

namespace bodesmith::kicad {
namespace {

const char* const kSmallPackage = "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm";

/// A name and a step of wire at a pin on the left or right side of a symbol; ground gets its own symbol.
void name_pin(Cell& cell, Point at, const std::string& net, bool left) {
  if (net == "0") {
    const Point end = at + Point{left ? -2 : 2, 0};
    cell.drawing.wire(at, end, net);
    cell.drawing.supply("GND", end, net);
    return;
  }
  cell.drawing.wire(at, at + Point{left ? -1 : 1, 0}, net);
  cell.drawing.label({at + Point{left ? -1 : 1, 0}, net, left});
}

Symbol device(const std::string& kind, const std::string& reference, const std::string& value,
              const std::string& netlist, const std::string& footprint, std::vector<std::string> pins) {
  Symbol out;
  out.kind = kind;
  out.reference = reference;
  out.value = value;
  out.footprint = footprint;
  out.pins = std::move(pins);
  if (!netlist.empty()) out.fields = {{"Netlist", netlist}};
  return out;
}

}  // namespace

Cell multiplier_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                     const std::string& x, const std::string& y, const std::string& z, const std::string& w) {
  Cell out;
  Symbol symbol =
      device("AD835", reference, value, netlist, kSmallPackage, {"1", "2", "3", "4", "5", "6", "7", "8"});
  symbol.text_to_right = true;
  symbol.reference_mm[0] = symbol.value_mm[0] = 2.54;
  symbol.reference_mm[1] = -11.43;
  symbol.value_mm[1] = 11.43;
  out.drawing.symbol(std::move(symbol), {{{-8, 2}, y},
                                         {{-8, 4}, "0"},
                                         {{0, 10}, "V5N"},
                                         {{-8, 6}, z},
                                         {{8, 0}, w},
                                         {{0, -10}, "V5P"},
                                         {{-8, -2}, "0"},
                                         {{-8, -4}, x}});
  name_pin(out, {-8, -4}, x, true);
  name_pin(out, {-8, 2}, y, true);
  name_pin(out, {-8, 6}, z, true);
  // Both other inputs share a ground line.
  for (const int row : {-2, 4}) out.drawing.wire({-8, row}, {-14, row}, "0");
  out.drawing.wire({-14, -2}, {-14, 4}, "0");
  out.drawing.supply("GND", {-14, 8}, "0");
  out.drawing.wire({-14, 4}, {-14, 8}, "0");
  name_pin(out, {8, 0}, w, false);
  out.drawing.supply("V5P", {0, -10}, "V5P");
  out.drawing.supply("V5N", {0, 10}, "V5N");
  out.drawing.reach({12, 14});
  return out;
}

Cell contact_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                  int unit, const std::string& from, const std::string& to, const std::string& control) {
  static const char* const kPins[4][3] = {
      {"1", "3", "2"}, {"16", "14", "15"}, {"9", "11", "10"}, {"8", "6", "7"}};  // IN, S, D
  Cell out;
  const auto& pins = kPins[unit];
  Symbol symbol = device("ADG413", reference, value, netlist, "Package_SO:SOIC-16_3.9x9.9mm_P1.27mm",
                         {pins[0], pins[1], pins[2]});
  symbol.unit = unit + 1;
  symbol.reference_mm[1] = -5.08;
  symbol.value_mm[1] = 7.62;
  out.drawing.symbol(std::move(symbol), {{{-6, 2}, control}, {{-6, 0}, from}, {{6, 0}, to}});
  name_pin(out, {-6, 2}, control, true);
  if (from == "0" && control == "0") {
    // One ground for both: two next to each other stand on each other's names.
    out.drawing.wire({-6, 0}, {-8, 0}, from);
    out.drawing.wire({-8, 0}, {-8, 2}, from);
  } else {
    name_pin(out, {-6, 0}, from, true);
  }
  name_pin(out, {6, 0}, to, false);
  out.drawing.reach({8, -6});
  out.drawing.reach({8, 8});
  return out;
}

Cell contact_supply_cell(const std::string& reference, const std::string& value) {
  Cell out;
  Symbol symbol =
      device("ADG413", reference, value, "", "Package_SO:SOIC-16_3.9x9.9mm_P1.27mm", {"13", "4", "5", "12"});
  symbol.unit = 5;
  symbol.text_to_right = true;
  symbol.reference_mm[0] = symbol.value_mm[0] = 6.35;
  symbol.reference_mm[1] = -7.62;
  symbol.value_mm[1] = 7.62;
  out.drawing.symbol(std::move(symbol), {{{0, -8}, "VCC"}, {{0, 8}, "VEE"}, {{-6, 0}, "0"}, {{6, 0}, "V5P"}});
  out.drawing.supply("VCC", {0, -8}, "VCC");
  out.drawing.supply("VEE", {0, 8}, "VEE");
  out.drawing.wire({-6, 0}, {-8, 0}, "0");
  out.drawing.supply("GND", {-8, 0}, "0");
  out.drawing.wire({6, 0}, {8, 0}, "V5P");
  out.drawing.supply("V5P", {8, 0}, "V5P");
  out.drawing.reach({16, 12});
  return out;
}

Cell diode_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                const std::string& anode, const std::string& cathode) {
  Cell out;
  Symbol symbol = device("D", reference, value, netlist, "Diode_SMD:D_SOD-123", {"1", "2"});
  symbol.reference_mm[1] = -2.54;
  symbol.value_mm[1] = 2.54;
  out.drawing.symbol(std::move(symbol), {{{3, 0}, cathode}, {{-3, 0}, anode}});
  name_pin(out, {-3, 0}, anode, true);
  name_pin(out, {3, 0}, cathode, false);
  out.drawing.reach({3, -4});
  out.drawing.reach({3, 4});
  return out;
}

Cell reference_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                    const std::string& net) {
  Cell out;
  Symbol symbol = device("VoltageReference", reference, value, netlist, kSmallPackage, {"2", "6", "4"});
  symbol.text_to_right = true;
  symbol.reference_mm[0] = -5.08;
  symbol.reference_mm[1] = -6.35;
  symbol.value_mm[0] = 6.35;
  symbol.value_mm[1] = 3.81;
  out.drawing.symbol(std::move(symbol), {{{-6, 0}, "V5P"}, {{6, 0}, net}, {{0, 6}, "0"}});
  out.drawing.wire({-6, 0}, {-8, 0}, "V5P");
  out.drawing.supply("V5P", {-8, 0}, "V5P");
  name_pin(out, {6, 0}, net, false);
  out.drawing.supply("GND", {0, 6}, "0");
  out.drawing.reach({18, -7});
  return out;
}

Cell connector_cell(const std::string& reference, const std::string& net) {
  Cell out;
  Symbol symbol = device("Conn_1x02", reference, net, "",
                         "Connector_PinHeader_2.54mm:PinHeader_1x02_P2.54mm_Vertical", {"1", "2"});
  symbol.reference_mm[1] = -5.08;
  symbol.value_mm[1] = 6.35;
  out.drawing.symbol(std::move(symbol), {{{4, 0}, net}, {{4, 2}, "0"}});
  out.drawing.wire({4, 0}, {6, 0}, net);
  out.drawing.label({{6, 0}, net, false});
  out.drawing.wire({4, 2}, {6, 2}, "0");
  out.drawing.supply("GND", {6, 2}, "0");
  out.drawing.reach({-3, -5});
  return out;
}

Cell supply_connector_cell(const std::string& reference, const std::string& positive,
                           const std::string& negative) {
  Cell out;
  Drawing& drawing = out.drawing;
  Symbol symbol = device("Conn_1x03", reference, "supply", "",
                         "Connector_PinHeader_2.54mm:PinHeader_1x03_P2.54mm_Vertical", {"1", "2", "3"});
  symbol.reference_mm[1] = -5.08;
  symbol.value_mm[1] = 6.35;
  drawing.symbol(std::move(symbol), {{{4, -2}, positive}, {{4, 0}, "0"}, {{4, 2}, negative}});
  drawing.reach({-3, -5});
  drawing.wire({4, -2}, {16, -2}, positive);
  drawing.supply(positive, {8, -2}, positive);
  drawing.supply("PWR_FLAG", {16, -2}, positive);
  drawing.wire({4, 0}, {26, 0}, "0");
  // One flag a net: ground has it at the op-amps' supply.
  if (positive == "VCC") drawing.supply("PWR_FLAG", {26, 0}, "0");
  drawing.wire({26, 0}, {26, 1}, "0");
  drawing.supply("GND", {26, 1}, "0");
  drawing.wire({4, 2}, {16, 2}, negative);
  drawing.supply(negative, {8, 2}, negative);
  drawing.supply("PWR_FLAG", {16, 2}, negative, 180);
  drawing.reach({30, 6});
  return out;
}

Cell package_supply_cell(Symbol unit, const std::array<std::string, 2>& capacitors) {
  Cell out;
  Drawing& drawing = out.drawing;
  const int name = static_cast<int>(unit.value.size()) + 1;
  unit.text_to_right = true;
  unit.reference_mm[0] = unit.value_mm[0] = 1.27;
  unit.reference_mm[1] = -1.27;
  unit.value_mm[1] = 1.27;
  drawing.symbol(std::move(unit), {{{0, -6}, "VCC"}, {{0, 6}, "VEE"}});
  drawing.reach({name, 0});
  drawing.supply("VCC", {0, -6}, "VCC");
  drawing.supply("VEE", {0, 6}, "VEE");
  for (const bool upper : {true, false}) {
    schematic::Part part;
    part.kind = schematic::Part::Kind::capacitor;
    Symbol texts;
    texts.reference = capacitors[upper ? 0 : 1];
    texts.value = "100n";
    texts.footprint = "Capacitor_SMD:C_0603_1608Metric";
    // Next to the package: VCC to ground above, ground to VEE below.
    const int x = -16, y = upper ? -3 : 3;
    drawing.part(part, texts, {x, y}, false, upper ? "VCC" : "0", upper ? "0" : "VEE");
    const int rail = upper ? -6 : 6;
    drawing.wire({x, rail}, {0, rail}, upper ? "VCC" : "VEE");
  }
  drawing.wire({-16, 0}, {-20, 0}, "0");
  drawing.supply("GND", {-20, 0}, "0");
  drawing.reach({-22, 0});
  return out;
}

Cell spare_opamp_cell(Symbol symbol) {
  Cell out;
  Drawing& drawing = out.drawing;
  symbol.text_to_right = true;
  symbol.reference_mm[0] = symbol.value_mm[0] = 2.54;
  symbol.reference_mm[1] = -5.08;
  symbol.value_mm[1] = 5.08;
  symbol.fields = {{"Netlist", "spare"}};
  const std::string net = "spare";
  drawing.symbol(std::move(symbol), {{{-6, -2}, net}, {{-6, 2}, "0"}, {{6, 0}, net}});
  drawing.wire({-6, -2}, {-8, -2}, net);
  drawing.wire({-8, -2}, {-8, -7}, net);
  drawing.wire({-8, -7}, {8, -7}, net);
  drawing.wire({8, -7}, {8, 0}, net);
  drawing.wire({8, 0}, {6, 0}, net);
  drawing.wire({-6, 2}, {-8, 2}, "0");
  drawing.supply("GND", {-8, 2}, "0");
  return out;
}

Symbol opamp_symbol(const std::string& reference, const std::string& type, int per_package, int unit) {
  const bool dual = per_package == 2;
  Symbol out = device(dual ? "OpAmp_Dual" : "OpAmp", reference, type, "", kSmallPackage, {});
  out.unit = unit + 1;
  if (unit == per_package) {
    out.pins = dual ? std::vector<std::string>{"8", "4"} : std::vector<std::string>{"7", "4"};
  } else if (dual) {
    out.pins = unit == 0 ? std::vector<std::string>{"1", "2", "3"} : std::vector<std::string>{"5", "6", "7"};
  } else {
    out.pins = {"2", "3", "6"};
  }
  return out;
}

}  // namespace bodesmith::kicad
