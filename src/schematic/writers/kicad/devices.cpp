#include "schematic/writers/kicad/devices.hpp"

namespace bodesmith::kicad {
namespace {

const char* const kSmallPackage = "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm";
const char* const kSwitchPackage = "Package_SO:SOIC-16_3.9x9.9mm_P1.27mm";

struct Texts {
  double reference_x, reference_y, value_x, value_y;
  bool to_right;  ///< of there, instead of centred
};

void place_texts(Symbol& symbol, const Texts& texts) {
  symbol.reference_mm[0] = texts.reference_x;
  symbol.reference_mm[1] = texts.reference_y;
  symbol.value_mm[0] = texts.value_x;
  symbol.value_mm[1] = texts.value_y;
  symbol.text_to_right = texts.to_right;
}

Symbol device(const std::string& kind, const std::string& reference, const std::string& value,
              const std::string& netlist, const std::string& footprint, std::vector<std::string> pins,
              const Texts& texts = {}) {
  Symbol out;
  out.kind = kind;
  out.reference = reference;
  out.value = value;
  out.footprint = footprint;
  out.pins = std::move(pins);
  place_texts(out, texts);
  if (!netlist.empty()) out.fields = {{"Netlist", netlist}};
  return out;
}

/// The symbol with every pin's net: its name behind a step of wire, or the supply's symbol, on the left and right two
/// steps away.
Cell wired(Symbol symbol, const std::vector<Tap>& pins) {
  Cell out;
  out.drawing.symbol(std::move(symbol), pins);
  for (const Tap& pin : pins) {
    const int way = pin.at.x < 0 ? -1 : pin.at.x > 0 ? 1 : 0;
    const bool supply =
        pin.net == "0" || pin.net == "VCC" || pin.net == "VEE" || pin.net == "V5P" || pin.net == "V5N";
    const Point end = pin.at + Point{supply ? 2 * way : way, 0};
    out.drawing.wire(pin.at, end, pin.net);
    if (supply)
      out.drawing.supply(pin.net == "0" ? "GND" : pin.net, end, pin.net);
    else
      out.drawing.label({end, pin.net, way < 0});
  }
  return out;
}

/// Pins at ground whose own symbols would stand on each other's names: a line down to one at `end`.
void shared_ground(Cell& cell, const std::vector<Point>& pins, Point end) {
  Point before = pins.front();
  for (const Point pin : pins) {
    cell.drawing.taps.push_back({pin, "0"});
    cell.drawing.wire(pin, {end.x, pin.y}, "0");
    cell.drawing.wire({end.x, before.y}, {end.x, pin.y}, "0");
    before = pin;
  }
  cell.drawing.wire({end.x, before.y}, end, "0");
  cell.drawing.supply("GND", end, "0");
}

}  // namespace

Cell multiplier_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                     const std::string& x, const std::string& y, const std::string& z, const std::string& w) {
  Cell out =
      wired(device("AD835", reference, value, netlist, kSmallPackage,
                   {"1", "2", "3", "4", "5", "6", "7", "8"}, {2.54, -11.43, 2.54, 11.43, true}),
            {{{-8, -4}, x}, {{-8, 2}, y}, {{-8, 6}, z}, {{8, 0}, w}, {{0, -10}, "V5P"}, {{0, 10}, "V5N"}});
  shared_ground(out, {{-8, -2}, {-8, 4}}, {-14, 8});
  out.drawing.reach({12, 14});
  return out;
}

Cell contact_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                  int unit, const std::string& from, const std::string& to, const std::string& control) {
  static const char* const kPins[4][3] = {
      {"1", "3", "2"}, {"16", "14", "15"}, {"9", "11", "10"}, {"8", "6", "7"}};  // IN, S, D
  const auto& pins = kPins[unit];
  Symbol symbol = device("ADG413", reference, value, netlist, kSwitchPackage, {pins[0], pins[1], pins[2]},
                         {0, -5.08, 0, 7.62, false});
  symbol.unit = unit + 1;
  std::vector<Tap> taps = {{{6, 0}, to}};
  const bool grounded = from == "0" && control == "0";
  if (!grounded) taps.insert(taps.end(), {{{-6, 0}, from}, {{-6, 2}, control}});
  Cell out = wired(std::move(symbol), taps);
  if (grounded) shared_ground(out, {{-6, 0}, {-6, 2}}, {-8, 2});
  out.drawing.reach({8, -6});
  out.drawing.reach({8, 8});
  return out;
}

Cell contact_supply_cell(const std::string& reference, const std::string& value) {
  Symbol symbol = device("ADG413", reference, value, "", kSwitchPackage, {"13", "4", "5", "12"},
                         {6.35, -7.62, 6.35, 7.62, true});
  symbol.unit = 5;
  Cell out = wired(std::move(symbol), {{{0, -8}, "VCC"}, {{0, 8}, "VEE"}, {{-6, 0}, "0"}, {{6, 0}, "V5P"}});
  out.drawing.reach({16, 12});
  return out;
}

Cell diode_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                const std::string& anode, const std::string& cathode) {
  Cell out = wired(
      device("D", reference, value, netlist, "Diode_SMD:D_SOD-123", {"1", "2"}, {0, -2.54, 0, 2.54, false}),
      {{{-3, 0}, anode}, {{3, 0}, cathode}});
  out.drawing.reach({3, -4});
  out.drawing.reach({3, 4});
  return out;
}

Cell reference_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                    const std::string& net) {
  Cell out = wired(device("VoltageReference", reference, value, netlist, kSmallPackage, {"2", "6", "4"},
                          {-5.08, -6.35, 6.35, 3.81, true}),
                   {{{-6, 0}, "V5P"}, {{6, 0}, net}, {{0, 6}, "0"}});
  out.drawing.reach({18, -7});
  return out;
}

Cell connector_cell(const std::string& reference, const std::string& net) {
  Cell out = wired(
      device("Conn_1x02", reference, net, "", "Connector_PinHeader_2.54mm:PinHeader_1x02_P2.54mm_Vertical",
             {"1", "2"}, {0, -5.08, 0, 6.35, false}),
      {{{4, 0}, net}, {{4, 2}, "0"}});
  out.drawing.reach({-3, -5});
  return out;
}

Cell supply_connector_cell(const std::string& reference, const std::string& positive,
                           const std::string& negative) {
  Cell out;
  Drawing& drawing = out.drawing;
  drawing.symbol(device("Conn_1x03", reference, "supply", "",
                        "Connector_PinHeader_2.54mm:PinHeader_1x03_P2.54mm_Vertical", {"1", "2", "3"},
                        {0, -5.08, 0, 6.35, false}),
                 {{{4, -2}, positive}, {{4, 0}, "0"}, {{4, 2}, negative}});
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
  const int name = static_cast<int>(unit.value.size()) + 1;
  place_texts(unit, {1.27, -1.27, 1.27, 1.27, true});
  Cell out = wired(std::move(unit), {{{0, -6}, "VCC"}, {{0, 6}, "VEE"}});
  Drawing& drawing = out.drawing;
  drawing.reach({name, 0});
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
  place_texts(symbol, {2.54, -5.08, 2.54, 5.08, true});
  symbol.fields = {{"Netlist", "spare"}};
  const std::string net = "spare";
  Cell out = wired(std::move(symbol), {{{-6, 2}, "0"}});
  out.drawing.taps.insert(out.drawing.taps.end(), {{{-6, -2}, net}, {{6, 0}, net}});
  const std::vector<Point> loop = {{-6, -2}, {-8, -2}, {-8, -7}, {8, -7}, {8, 0}, {6, 0}};
  for (std::size_t i = 1; i < loop.size(); ++i) out.drawing.wire(loop[i - 1], loop[i], net);
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
