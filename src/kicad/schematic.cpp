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
#include "kicad/text.hpp"

namespace bodesmith::kicad {
namespace {

using circuit::plain_number;

struct Paper {
  const char* name;
  int width, height;  // steps
};
constexpr Paper kPapers[] = {{"A4", 233, 165}, {"A3", 330, 233}};
constexpr int kMargin = 14;
constexpr int kTitleBlock = 30;  // kept free at the bottom
constexpr int kGap = 6;          // between cells

/// Sizes in which stable dielectrics (C0G to 100 nF, film above) are sold.
const char* capacitor_footprint(double farad) {
  if (farad <= 10e-9) return "Capacitor_SMD:C_0603_1608Metric";
  if (farad <= 100e-9) return "Capacitor_SMD:C_1206_3216Metric";
  if (farad <= 220e-9) return "Capacitor_SMD:C_1210_3225Metric";
  return "Capacitor_THT:C_Rect_L7.2mm_W5.5mm_P5.00mm_FKS2_FKP2_MKS2_MKP2";
}

/// Cells that stay together, and what is written above them.
struct Group {
  std::vector<Cell> cells;
  std::string text;
  std::string in, out;

  int width() const {
    int sum = 0;
    for (const Cell& cell : cells) sum += cell.drawing.right - cell.drawing.left + kGap;
    return std::max(sum, text_width());
  }
  int text_width() const {
    size_t longest = 0;
    for (const std::string_view line : split(text, '\n')) longest = std::max(longest, line.size());
    return static_cast<int>(longest) + kGap;
  }
  int text_height() const { return 2 * static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 3; }
};

/// Rows from left to right and downwards on one sheet.
class Rows {
 public:
  explicit Rows(const Paper& paper) : paper_(paper) {}

  /// False when the group does not fit any more.
  bool add(const Group& group) {
    const int usable = paper_.width - 2 * kMargin;
    if (group.width() <= usable) return place(group, 0, group.cells.size());
    // Too wide for one row: as many cells as fit, and the rest below.
    for (size_t first = 0; first < group.cells.size();) {
      size_t last = first;
      int width = 0;
      while (last < group.cells.size()) {
        width += group.cells[last].drawing.right - group.cells[last].drawing.left + kGap;
        if (width > usable && last > first) break;
        ++last;
      }
      if (!place(group, first, last)) return false;
      first = last;
    }
    return true;
  }

  /// The rows at their heights. Cells beside each other whose ends are one net are wired, others named.
  Drawing drawing() {
    Drawing out;
    int y = kMargin;
    std::vector<std::vector<bool>> named;
    const std::map<std::string, int> uses = count_uses();
    for (const Row& row : rows_) {
      const int axis = y + row.ascent;
      for (size_t i = 0; i < row.items.size(); ++i) {
        const Item& item = row.items[i];
        const Item* next = i + 1 < row.items.size() ? &row.items[i + 1] : nullptr;
        const Item* before = i > 0 ? &row.items[i - 1] : nullptr;
        out.append(item.cell.drawing, {item.x, axis});
        for (size_t a = 0; a < item.cell.anchors.size(); ++a)
          finish(item, a, axis, before && wired(*before, item), next && wired(item, *next), uses, out);
        if (next && wired(item, *next)) connect(item, *next, axis, out);
        if (!item.text.empty()) {
          out.texts.push_back({{item.x + item.cell.drawing.left, y + item.text_height - 2}, item.text});
        }
      }
      y += row.ascent + row.descent;
    }
    return out;
  }
  bool empty() const { return rows_.empty(); }
  int height() const {
    int out = 0;
    for (const Row& row : rows_) out += row.ascent + row.descent;
    return out;
  }

 private:
  struct Item {
    int x = 0;  ///< of the cell's origin
    Cell cell;
    std::string text;
    int text_height = 0;
  };
  struct Row {
    int ascent = 0, descent = 0, width = 0;
    std::vector<Item> items;
  };

  bool place(const Group& group, size_t first, size_t last) {
    const int usable = paper_.width - 2 * kMargin;
    int width = first == 0 ? group.text_width() : 0, cells = 0, ascent = 0, descent = 0;
    for (size_t i = first; i < last; ++i) {
      const Drawing& drawing = group.cells[i].drawing;
      cells += drawing.right - drawing.left + kGap;
      ascent = std::max(ascent, -drawing.top);
      descent = std::max(descent, drawing.bottom);
    }
    width = std::max(width, cells);
    ascent += (group.text.empty() ? 1 : group.text_height() + 1);
    descent += 2;
    const bool new_row = rows_.empty() || rows_.back().width + width > usable;
    const Row empty;
    const Row& into = new_row ? empty : rows_.back();
    const int grows =
        std::max(into.ascent, ascent) + std::max(into.descent, descent) - into.ascent - into.descent;
    if (height() + grows > paper_.height - kMargin - kTitleBlock) return false;
    if (new_row) rows_.emplace_back();
    Row& row = rows_.back();
    row.ascent = std::max(row.ascent, ascent);
    row.descent = std::max(row.descent, descent);
    int x = kMargin + row.width;
    for (size_t i = first; i < last; ++i) {
      const Drawing& drawing = group.cells[i].drawing;
      const bool titled = i == 0;
      row.items.push_back(
          {x - drawing.left, group.cells[i], titled ? group.text : "", titled ? group.text_height() : 0});
      x += drawing.right - drawing.left + kGap;
    }
    row.width += width;
    return true;
  }

  static bool wired(const Item& left, const Item& right) {
    return left.cell.exit && right.cell.entry &&
           left.cell.anchors[*left.cell.exit].net == right.cell.anchors[*right.cell.entry].net;
  }

  /// In how many cells a net has an anchor.
  std::map<std::string, int> count_uses() const {
    std::map<std::string, int> out;
    for (const Row& row : rows_) {
      for (const Item& item : row.items) {
        std::set<std::string> here;
        for (const Anchor& anchor : item.cell.anchors) here.insert(anchor.net);
        for (const std::string& net : here) ++out[net];
      }
    }
    return out;
  }

  static void finish(const Item& item, size_t index, int axis, bool wired_before, bool wired_after,
                     const std::map<std::string, int>& uses, Drawing& out) {
    const Anchor& anchor = item.cell.anchors[index];
    const Point at = anchor.at + Point{item.x, axis};
    switch (anchor.kind) {
      case Anchor::Kind::end:
        if (wired_before && item.cell.entry == index) return;
        out.wire(at + Point{-1, 0}, at, anchor.net);
        out.label({at + Point{-1, 0}, anchor.net, true});
        break;
      case Anchor::Kind::inner:
        // An output that is also an input (a follower) has its name there already.
        if ((uses.at(anchor.net) > 1 || ends_in(item, anchor.net)) && !is_output(item, anchor.net))
          out.label({at, anchor.net, true});
        break;
      case Anchor::Kind::output:
        if (!(wired_after && item.cell.exit == index)) out.wire(at, at + Point{1, 0}, anchor.net);
        out.label({at + Point{1, 0}, anchor.net, false});
        break;
    }
  }

  /// Another piece of the net in the same cell.
  static bool ends_in(const Item& item, const std::string& net) {
    return std::any_of(item.cell.anchors.begin(), item.cell.anchors.end(),
                       [&](const Anchor& one) { return one.kind == Anchor::Kind::end && one.net == net; });
  }

  static bool is_output(const Item& item, const std::string& net) {
    return item.cell.exit && item.cell.anchors[*item.cell.exit].net == net;
  }

  static void connect(const Item& left, const Item& right, int axis, Drawing& out) {
    const Anchor &from = left.cell.anchors[*left.cell.exit], &to = right.cell.anchors[*right.cell.entry];
    const Point a = from.at + Point{left.x, axis}, b = to.at + Point{right.x, axis};
    const Point corner{b.x - 2, a.y};
    out.wire(a, corner, from.net);
    out.wire(corner, {corner.x, b.y}, from.net);
    out.wire({corner.x, b.y}, b, from.net);
  }

  Paper paper_;
  std::vector<Row> rows_;
};

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
