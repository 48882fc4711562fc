#include "kicad/schematic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "base/whole_number.hpp"
#include "circuit/text.hpp"
#include "kicad/bom.hpp"
#include "kicad/cell.hpp"
#include "kicad/devices.hpp"
#include "kicad/sheet_rows.hpp"
#include "kicad/text.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/references.hpp"

namespace bodesmith::kicad {
namespace {

using schematic::plain_number;

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
    schematic::ReferenceCounter counter;
    const std::vector<std::string> references = schematic::part_references(circuit, counter);
    for (size_t i = 0; i < references.size(); ++i) references_[circuit.parts[i].name] = references[i];
    for (size_t i = 0; i < circuit.stages.size(); ++i) groups_.push_back(stage_group(i));
    board_ = board_groups();
  }

  /// One sheet when A3 is enough, otherwise a first sheet with a box for each of the others.
  std::vector<Sheet> sheets() const {
    std::vector<const Group*> all;
    for (const Group& group : groups_) all.push_back(&group);
    for (const Group& group : board_) all.push_back(&group);
    for (const Paper& paper : {kPapers[0], kPapers[1]}) {
      const Rows rows = fitted_rows(paper, all);
      if (!rows.empty()) return {{"compensator.kicad_sch", paper.name, rows.drawing(), {}}};
    }
    return with_boxes();
  }

 private:
  std::vector<Sheet> with_boxes() const {
    const Paper& paper = paper_for_stages();
    std::vector<Sheet> out(1);
    std::vector<SheetBox> boxes;
    const auto add = [&](Sheet sheet, const std::string& name, const std::string& in,
                         const std::string& end) {
      sheet.file = fmt::format("compensator_{}.kicad_sch", out.size() + 1);
      SheetBox box;
      box.name = name;
      box.file = sheet.file;
      box.in = in;
      box.out = end;
      boxes.push_back(box);
      out.push_back(std::move(sheet));
    };
    for (auto& [sheet, first, last] : filled(paper, groups_, 0)) {
      make_port(sheet.drawing, groups_[first].in, Label::Kind::input);
      make_port(sheet.drawing, groups_[last - 1].out, Label::Kind::output);
      add(std::move(sheet),
          last == first + 1 ? fmt::format("stage {}", last) : fmt::format("stages {} to {}", first + 1, last),
          groups_[first].in, groups_[last - 1].out);
    }
    // Connectors and supplies below the boxes, or, when there are too many, the supplies on sheets like the stages.
    std::vector<const Group*> board;
    for (const Group& group : board_) board.push_back(&group);
    const auto below = [&](const Paper& size) { return kMargin + kBoxLine * lines_of(boxes.size(), size); };
    if (fitted_rows(paper, board, below(paper)).empty()) {
      board.resize(1);
      int number = 0;
      for (auto& [sheet, first, last] : filled(paper, board_, 1))
        add(std::move(sheet), fmt::format("supplies {}", ++number), "", "");
    }
    for (const Paper& size : kPapers) {
      const Rows rows = fitted_rows(size, board, below(size));
      if (rows.empty()) continue;
      Sheet& root = out[0];
      root.file = "compensator.kicad_sch";
      root.paper = size.name;
      root.boxes = boxes;
      place_boxes(root, columns_of(size));
      root.drawing.append(rows.drawing(), {0, 0});
      return out;
    }
    throw DesignError("the circuit is larger than a KiCad project of A0 sheets");
  }

  static constexpr int kBoxWidth = 28, kBoxHeight = 16, kBoxStep = 42, kBoxLine = 26;
  static int columns_of(const Paper& paper) { return (paper.width - 2 * kMargin) / kBoxStep; }
  static int lines_of(size_t boxes, const Paper& paper) {
    return (static_cast<int>(boxes) + columns_of(paper) - 1) / columns_of(paper);
  }

  /// Sheets that take the groups from `first` on in their order, as many as each holds.
  struct Filled {
    Sheet sheet;
    size_t first = 0, last = 0;
  };
  static std::vector<Filled> filled(const Paper& paper, const std::vector<Group>& groups, size_t first) {
    std::vector<Filled> out;
    while (first < groups.size()) {
      Rows rows(paper);
      std::vector<const Group*> here;
      size_t last = first;
      while (last < groups.size() && rows.add(groups[last])) here.push_back(&groups[last++]);
      out.push_back({{"", paper.name, fitted_rows(paper, here).drawing(), {}}, first, last});
      first = last;
    }
    return out;
  }

  /// In lines of `across`, the signal from each to the next by a wire or, at the end of a line, by name.
  static void place_boxes(Sheet& root, int across) {
    Drawing& drawing = root.drawing;
    for (size_t i = 0; i < root.boxes.size(); ++i) {
      SheetBox& box = root.boxes[i];
      const int column = static_cast<int>(i) % across, line = static_cast<int>(i) / across;
      box.at = {kMargin + 6 + column * kBoxStep, kMargin + 4 + line * kBoxLine};
      box.width = kBoxWidth;
      box.height = kBoxHeight;
      drawing.reach(box.at + Point{kBoxWidth, kBoxHeight + 2});
      if (box.in.empty()) continue;
      const int y = box.at.y + kBoxHeight / 2;
      const Point in{box.at.x, y}, end{box.at.x + kBoxWidth, y};
      drawing.taps.push_back({in, box.in});
      drawing.taps.push_back({end, box.out});
      const bool wired_before = i > 0 && column > 0;
      const bool wired_after =
          i + 1 < root.boxes.size() && column + 1 < across && !root.boxes[i + 1].in.empty();
      if (!wired_before) {
        drawing.wire(in + Point{-2, 0}, in, box.in);
        drawing.label({in + Point{-2, 0}, box.in, true});
      }
      drawing.wire(end, end + Point{wired_after ? kBoxStep - kBoxWidth : 2, 0}, box.out);
      drawing.label({end + Point{2, 0}, box.out, false});
    }
  }

  /// A3, or what the largest stage needs.
  const Paper& paper_for_stages() const {
    for (const Paper& paper : kPapers) {
      const bool holds = std::all_of(groups_.begin(), groups_.end(),
                                     [&](const Group& group) { return Rows(paper).add(group); });
      if (holds && paper.width >= kPapers[1].width) return paper;
    }
    throw DesignError("a stage is larger than an A0 sheet");
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

  Symbol texts_of(const schematic::Part& part) const {
    const bool resistor = part.kind == schematic::Part::Kind::resistor;
    const char* const unit = resistor ? " ohm" : " F";
    Symbol out;
    out.reference = references_.at(part.name);
    out.value = kicad_value(part.realised);
    out.footprint = resistor ? "Resistor_SMD:R_0603_1608Metric" : capacitor_footprint(part.realised);
    out.fields = {
        {"Netlist", part.name},
        {"Series", part.series},
        {"Tolerance",
         rounded_text(resistor ? tolerances_.resistor_percent : tolerances_.capacitor_percent) + "%"},
        {"Wanted", plain_number(part.wanted) + unit},
        {"Realised", plain_number(part.realised) + unit},
        {"Section", std::to_string(part.group + 1)}};
    return out;
  }

  /// A unit of a package; the power unit comes after the op-amps.
  Symbol opamp_unit(int package, int unit) const {
    return opamp_symbol(fmt::format("U{}", package + 1), circuit_.opamp.name, circuit_.opamp.per_package,
                        unit);
  }

  Group stage_group(size_t index) const {
    const circuit::Stage& stage = circuit_.stages[index];
    const std::span<const schematic::Part> placed = circuit_.parts_of(stage);
    const std::vector<schematic::Part> parts(placed.begin(), placed.end());
    std::vector<schematic::OpAmp> opamps;
    for (const schematic::OpAmp& opamp : circuit_.opamps) {
      if (opamp.group == index) opamps.push_back(opamp);
    }
    Group out;
    out.in = stage.in;
    out.out = stage.out;
    out.cells = stage_cells(
        parts, opamps, stage.in, stage.out, [&](const schematic::Part& part) { return texts_of(part); },
        [&](const schematic::OpAmp& opamp) {
          const auto place =
              std::find_if(circuit_.opamps.begin(), circuit_.opamps.end(),
                           [&](const schematic::OpAmp& other) { return other.name == opamp.name; });
          const int number = static_cast<int>(place - circuit_.opamps.begin());
          Symbol symbol =
              opamp_unit(number / circuit_.opamp.per_package, number % circuit_.opamp.per_package);
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

  /// Connectors, supplies, and the packages' power units with their capacitors.
  std::vector<Group> board_groups() const {
    std::vector<Group> out(1);
    schematic::ReferenceCounter counter;
    for (const schematic::Part& part : circuit_.parts) {
      if (part.kind == schematic::Part::Kind::capacitor) counter.next("C");
    }
    Group& connectors = out[0];
    connectors.text = "connectors, supplies, 100 nF at every supply pin";
    connectors.cells.push_back(connector_cell("J1", "in"));
    connectors.cells.push_back(connector_cell("J2", "out"));
    connectors.cells.push_back(supply_connector_cell("J3", "VCC", "VEE"));
    const int per = circuit_.opamp.per_package;
    const int packages = (static_cast<int>(circuit_.opamps.size()) + per - 1) / per;
    for (int i = 0; i < packages; ++i) {
      Group group;
      group.cells.push_back(package_supply_cell(opamp_unit(i, per), {counter.next("C"), counter.next("C")}));
      out.push_back(std::move(group));
    }
    if (packages * per > static_cast<int>(circuit_.opamps.size())) {
      Group group;
      group.cells.push_back(spare_opamp_cell(opamp_unit(packages - 1, per - 1)));
      out.push_back(std::move(group));
    }
    return out;
  }

  const circuit::Circuit& circuit_;
  circuit::Tolerances tolerances_;
  std::map<std::string, std::string> references_;  ///< by name in the netlist
  std::vector<Group> groups_, board_;
};

}  // namespace

std::string kicad_value(double value) {
  static const std::map<int, const char*> kPrefixes = {
      {-15, "f"}, {-12, "p"}, {-9, "n"}, {-6, "u"}, {-3, "m"}, {0, ""}, {3, "k"}, {6, "M"}, {9, "G"}};
  const int power =
      std::clamp(3 * whole_number<int>(std::floor(std::log10(value) / 3.0 + 1e-9), -110, 110), -15, 9);
  return rounded_text(value / std::pow(10.0, power), 6) + kPrefixes.at(power);
}

void add_kicad_files(const circuit::Circuit& circuit, const std::string& title, OutputSet& out,
                     const circuit::Tolerances& tolerances) {
  const std::vector<Sheet> sheets = Schematic(circuit, tolerances).sheets();
  const std::vector<std::string> texts =
      sheet_texts(sheets, title, fmt::format("bodesmith {}; op-amps {}", kVersion, circuit.opamp.name));
  for (size_t i = 0; i < sheets.size(); ++i) out.add(sheets[i].file, texts[i]);
  Json project;
  project["meta"] = {{"filename", "compensator.kicad_pro"}, {"version", 1}};
  project["sheets"] = Json::array({Json::array({root_uuid(title), ""})});
  project["text_variables"] = Json::object();
  out.add("compensator.kicad_pro", to_text(project));
  out.add("bodesmith.kicad_sym", symbol_library_text());
  out.add("bom.csv", bill_of_materials(sheets));
  out.add("sym-lib-table", symbol_table_text());
}

}  // namespace bodesmith::kicad
