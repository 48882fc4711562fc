#include "kicad/schematic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "circuit/text.hpp"
#include "kicad/cell.hpp"
#include "kicad/sheet_rows.hpp"
#include "kicad/text.hpp"

namespace bodesmith::kicad {
namespace {

using circuit::plain_number;

/// Sizes in which stable dielectrics (C0G to 100 nF, film above) are sold.
const char* capacitor_footprint(double farad) {
  if (farad <= 10e-9) return "Capacitor_SMD:C_0603_1608Metric";
  if (farad <= 100e-9) return "Capacitor_SMD:C_1206_3216Metric";
  if (farad <= 220e-9) return "Capacitor_SMD:C_1210_3225Metric";
  return "Capacitor_THT:C_Rect_L7.2mm_W5.5mm_P5.00mm_FKS2_FKP2_MKS2_MKP2";
}

class Schematic {
 public:
  Schematic(const circuit::Circuit& circuit, const circuit::Tolerances& tolerances)
      : circuit_(circuit), tolerances_(tolerances) {
    for (size_t i = 0; i < circuit.stages.size(); ++i) groups_.push_back(stage_group(i));
    board_ = board_groups();
  }

  /// One sheet when A3 is enough, otherwise a first sheet with a box for each of the others.
  std::vector<Sheet> sheets() const {
    for (const Paper& paper : kPapers) {
      Rows rows(paper);
      const auto fits = [&](const std::vector<Group>& groups) {
        return std::all_of(groups.begin(), groups.end(), [&](const Group& group) { return rows.add(group); });
      };
      if (fits(groups_) && fits(board_)) return {{"compensator.kicad_sch", paper.name, rows.drawing(), {}}};
    }
    return with_boxes();
  }

 private:
  std::vector<Sheet> with_boxes() const {
    const Paper& paper = kPapers[1];
    std::vector<Sheet> out(1);
    size_t first = 0;
    while (first < groups_.size()) {
      Rows rows(paper);
      size_t last = first;
      while (last < groups_.size() && rows.add(groups_[last])) ++last;
      if (last == first) throw std::logic_error("a stage that is larger than a sheet");
      Sheet sheet{fmt::format("compensator_{}.kicad_sch", out.size() + 1), paper.name, rows.drawing(), {}};
      make_port(sheet.drawing, groups_[first].in, Label::Kind::input);
      make_port(sheet.drawing, groups_[last - 1].out, Label::Kind::output);
      SheetBox box;
      box.name =
          last == first + 1 ? fmt::format("stage {}", last) : fmt::format("stages {} to {}", first + 1, last);
      box.file = sheet.file;
      box.in = groups_[first].in;
      box.out = groups_[last - 1].out;
      out[0].boxes.push_back(box);
      out.push_back(std::move(sheet));
      first = last;
    }
    Sheet& root = out[0];
    root.file = "compensator.kicad_sch";
    root.paper = paper.name;
    // The boxes in rows above, supplies below.
    constexpr int kBoxWidth = 28, kBoxHeight = 16, kStep = 42;
    const int across = (paper.width - 2 * kMargin) / kStep;
    Drawing& drawing = root.drawing;
    for (size_t i = 0; i < root.boxes.size(); ++i) {
      SheetBox& box = root.boxes[i];
      const int column = static_cast<int>(i) % across, line = static_cast<int>(i) / across;
      box.at = {kMargin + 6 + column * kStep, kMargin + 4 + line * 26};
      box.width = kBoxWidth;
      box.height = kBoxHeight;
      const int y = box.at.y + kBoxHeight / 2;
      const Point in{box.at.x, y}, end{box.at.x + kBoxWidth, y};
      drawing.taps.push_back({in, box.in});
      drawing.taps.push_back({end, box.out});
      const bool wired_before = i > 0 && column > 0;
      const bool wired_after = i + 1 < root.boxes.size() && column + 1 < across;
      if (!wired_before) {
        drawing.wire(in + Point{-2, 0}, in, box.in);
        drawing.label({in + Point{-2, 0}, box.in, true});
      }
      drawing.wire(end, end + Point{wired_after ? kStep - kBoxWidth : 2, 0}, box.out);
      drawing.label({end + Point{2, 0}, box.out, false});
    }
    const int lines = (static_cast<int>(root.boxes.size()) + across - 1) / across;
    Rows rows(paper);
    for (const Group& group : board_) {
      if (!rows.add(group)) throw std::logic_error("more packages than one sheet holds");
    }
    drawing.append(rows.drawing(), {0, 26 * lines});
    return out;
  }

  /// The first label of the net leads out of the sheet.
  static void make_port(Drawing& drawing, const std::string& net, Label::Kind kind) {
    for (Label& label : drawing.labels) {
      if (label.net == net && label.to_left == (kind == Label::Kind::input)) {
        label.kind = kind;
        return;
      }
    }
    throw std::logic_error("the net " + net + " has no label to lead it out of the sheet");
  }

  Symbol texts_of(const circuit::Part& part) const {
    const bool resistor = part.kind == circuit::Part::Kind::resistor;
    const char* const unit = resistor ? " ohm" : " F";
    Symbol out;
    out.reference = part.name;
    out.value = kicad_value(part.realised);
    out.footprint = resistor ? "Resistor_SMD:R_0603_1608Metric" : capacitor_footprint(part.realised);
    out.fields = {
        {"Series", part.series},
        {"Tolerance",
         rounded_text(resistor ? tolerances_.resistor_percent : tolerances_.capacitor_percent) + "%"},
        {"Wanted", plain_number(part.wanted) + unit},
        {"Realised", plain_number(part.realised) + unit},
        {"Section", std::to_string(part.stage + 1)}};
    return out;
  }

  bool dual() const { return circuit_.model.per_package == 2; }

  /// A unit of a package; the power unit comes after the op-amps.
  Symbol opamp_unit(int package, int unit) const {
    Symbol out;
    out.kind = dual() ? "OpAmp_Dual" : "OpAmp";
    out.reference = fmt::format("U{}", package + 1);
    out.value = circuit_.model.name;
    out.footprint = "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm";
    out.unit = unit + 1;
    if (unit == circuit_.model.per_package) {
      out.pins = dual() ? std::vector<std::string>{"8", "4"} : std::vector<std::string>{"7", "4"};
    } else if (dual()) {
      out.pins =
          unit == 0 ? std::vector<std::string>{"1", "2", "3"} : std::vector<std::string>{"5", "6", "7"};
    } else {
      out.pins = {"2", "3", "6"};
    }
    return out;
  }

  Group stage_group(size_t index) const {
    const circuit::Stage& stage = circuit_.stages[index];
    const std::span<const circuit::Part> placed = circuit_.parts_of(stage);
    const std::vector<circuit::Part> parts(placed.begin(), placed.end());
    std::vector<circuit::OpAmp> opamps;
    for (const circuit::OpAmp& opamp : circuit_.opamps) {
      if (opamp.stage == index) opamps.push_back(opamp);
    }
    Group out;
    out.in = stage.in;
    out.out = stage.out;
    out.cells = stage_cells(
        parts, opamps, stage.in, stage.out, [&](const circuit::Part& part) { return texts_of(part); },
        [&](const circuit::OpAmp& opamp) {
          const auto place =
              std::find_if(circuit_.opamps.begin(), circuit_.opamps.end(),
                           [&](const circuit::OpAmp& other) { return other.name == opamp.name; });
          const int number = static_cast<int>(place - circuit_.opamps.begin());
          Symbol symbol =
              opamp_unit(number / circuit_.model.per_package, number % circuit_.model.per_package);
          symbol.fields = {{"Netlist", opamp.name}, {"Section", std::to_string(index + 1)}};
          return symbol;
        });
    out.text = fmt::format("stage {}: {}\n{}", index + 1, stage.realisation,
                           stage.wanted.size() == 1
                               ? circuit::transfer_text(stage.wanted)
                               : fmt::format("{} poles, {} to {} rad/s", stage.wanted.size(),
                                             rounded_text(std::abs(stage.wanted.front().section().poles[0])),
                                             rounded_text(std::abs(stage.wanted.back().section().poles[0]))));
    return out;
  }

  static Symbol connector(const std::string& kind, const std::string& reference, const std::string& value) {
    Symbol out;
    out.kind = kind;
    out.reference = reference;
    out.value = value;
    const bool three = kind == "Conn_1x03";
    out.footprint = three ? "Connector_PinHeader_2.54mm:PinHeader_1x03_P2.54mm_Vertical"
                          : "Connector_PinHeader_2.54mm:PinHeader_1x02_P2.54mm_Vertical";
    out.reference_mm[1] = -5.08;
    out.value_mm[1] = 6.35;
    out.pins = three ? std::vector<std::string>{"1", "2", "3"} : std::vector<std::string>{"1", "2"};
    return out;
  }

  /// Connectors, supplies, and the packages' power units with their capacitors.
  std::vector<Group> board_groups() const {
    std::vector<Group> out(1);
    Group& connectors = out[0];
    connectors.text = "connectors, supplies, 100 nF at every supply pin";
    for (const bool input : {true, false}) {
      Cell cell;
      const std::string net = input ? "in" : "out";
      cell.drawing.symbol(connector("Conn_1x02", input ? "J1" : "J2", net), {{{4, 0}, net}, {{4, 2}, "0"}});
      cell.drawing.wire({4, 0}, {6, 0}, net);
      cell.drawing.label({{6, 0}, net, false});
      cell.drawing.wire({4, 2}, {6, 2}, "0");
      cell.drawing.supply("GND", {6, 2}, "0");
      cell.drawing.reach({-3, -5});
      connectors.cells.push_back(std::move(cell));
    }
    Cell power;
    Drawing& drawing = power.drawing;
    drawing.symbol(connector("Conn_1x03", "J3", "supply"),
                   {{{4, -2}, "VCC"}, {{4, 0}, "0"}, {{4, 2}, "VEE"}});
    drawing.reach({-3, -5});
    drawing.wire({4, -2}, {16, -2}, "VCC");
    drawing.supply("VCC", {8, -2}, "VCC");
    drawing.supply("PWR_FLAG", {16, -2}, "VCC");
    drawing.wire({4, 0}, {26, 0}, "0");
    drawing.supply("PWR_FLAG", {26, 0}, "0");
    drawing.wire({26, 0}, {26, 1}, "0");
    drawing.supply("GND", {26, 1}, "0");
    drawing.wire({4, 2}, {16, 2}, "VEE");
    drawing.supply("VEE", {8, 2}, "VEE");
    drawing.supply("PWR_FLAG", {16, 2}, "VEE", 180);
    drawing.reach({30, 6});
    connectors.cells.push_back(std::move(power));
    const int per = circuit_.model.per_package;
    const int packages = (static_cast<int>(circuit_.opamps.size()) + per - 1) / per;
    for (int i = 0; i < packages; ++i) {
      Group group;
      group.cells.push_back(supply_cell(i));
      out.push_back(std::move(group));
    }
    if (packages * per > static_cast<int>(circuit_.opamps.size())) {
      Group group;
      group.cells.push_back(spare_cell(packages - 1, per - 1));
      out.push_back(std::move(group));
    }
    return out;
  }

  Cell supply_cell(int package) const {
    Cell out;
    Drawing& drawing = out.drawing;
    Symbol unit = opamp_unit(package, circuit_.model.per_package);
    unit.text_to_right = true;
    unit.reference_mm[0] = unit.value_mm[0] = 1.27;
    unit.reference_mm[1] = -1.27;
    unit.value_mm[1] = 1.27;
    drawing.symbol(std::move(unit), {{{0, -6}, "VCC"}, {{0, 6}, "VEE"}});
    drawing.reach({static_cast<int>(circuit_.model.name.size()) + 1, 0});
    drawing.supply("VCC", {0, -6}, "VCC");
    drawing.supply("VEE", {0, 6}, "VEE");
    for (const bool upper : {true, false}) {
      circuit::Part part;
      part.kind = circuit::Part::Kind::capacitor;
      Symbol texts;
      texts.reference = fmt::format("Cd{}", 2 * package + (upper ? 1 : 2));
      texts.value = "100n";
      texts.footprint = "Capacitor_SMD:C_0603_1608Metric";
      // Beside the package: VCC to ground above, ground to VEE below.
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

  Cell spare_cell(int package, int unit) const {
    Cell out;
    Drawing& drawing = out.drawing;
    Symbol symbol = opamp_unit(package, unit);
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

  const circuit::Circuit& circuit_;
  circuit::Tolerances tolerances_;
  std::vector<Group> groups_, board_;
};

}  // namespace

std::string kicad_value(double value) {
  static const std::map<int, const char*> kPrefixes = {
      {-15, "f"}, {-12, "p"}, {-9, "n"}, {-6, "u"}, {-3, "m"}, {0, ""}, {3, "k"}, {6, "M"}, {9, "G"}};
  const int power = std::clamp(3 * static_cast<int>(std::floor(std::log10(value) / 3.0 + 1e-9)), -15, 9);
  return rounded_text(value / std::pow(10.0, power), 6) + kPrefixes.at(power);
}

void add_kicad_files(const circuit::Circuit& circuit, const std::string& title, OutputSet& out,
                     const circuit::Tolerances& tolerances) {
  const std::vector<Sheet> sheets = Schematic(circuit, tolerances).sheets();
  const std::vector<std::string> texts =
      sheet_texts(sheets, title, fmt::format("bodesmith {}; op-amps {}", kVersion, circuit.model.name));
  for (size_t i = 0; i < sheets.size(); ++i) out.add(sheets[i].file, texts[i]);
  Json project;
  project["meta"] = {{"filename", "compensator.kicad_pro"}, {"version", 1}};
  project["sheets"] = Json::array({Json::array({root_uuid(title), ""})});
  project["text_variables"] = Json::object();
  out.add("compensator.kicad_pro", to_text(project));
  out.add("bodesmith.kicad_sym", symbol_library_text());
  out.add(
      "sym-lib-table",
      "(sym_lib_table\n  (lib (name \"bodesmith\")(type \"KiCad\")(uri \"${KIPRJMOD}/bodesmith.kicad_sym\")"
      "(options \"\")(descr \"symbols of bodesmith's schematics\"))\n)\n");
}

}  // namespace bodesmith::kicad
