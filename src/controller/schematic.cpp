#include "controller/schematic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/text.hpp"
#include "base/version.hpp"
#include "kicad/devices.hpp"
#include "kicad/schematic.hpp"
#include "kicad/sheet_rows.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/references.hpp"

namespace bodesmith::controller {
namespace {

using schematic::plain_number;

class SchematicMaker {
 public:
  SchematicMaker(const AnalogController& controller, const circuit::Tolerances& tolerances)
      : controller_(controller), tolerances_(tolerances) {
    const std::vector<std::string> references = schematic::part_references(controller, counter_);
    for (std::size_t i = 0; i < references.size(); ++i) references_[controller.parts[i].name] = references[i];
    for (const OpAmp& one : controller.opamps) place_opamp(one);
    for (const Multiplier& one : controller.multipliers) devices_[one.name] = next_package();
    switch_reference_ = next_package();
    for (const schematic::Source& one : controller.sources) devices_[one.name] = next_package();
    for (const Contact& one : controller.contacts) contact_units_[one.name] = free_unit(one.position == 0);
  }

  std::vector<kicad::Group> groups() {
    std::vector<kicad::Group> out;
    for (const std::size_t group : sheet_order()) out.push_back(section(group));
    kicad::Group board;
    board.text = "connectors, supplies, references";
    board.cells.push_back(kicad::connector_cell("J1", "r"));
    board.cells.push_back(kicad::connector_cell("J2", "v"));
    board.cells.push_back(kicad::supply_connector_cell("J3", "VCC", "VEE"));
    board.cells.push_back(kicad::supply_connector_cell("J4", "V5P", "V5N"));
    for (const schematic::Source& one : controller_.sources)
      board.cells.push_back(kicad::reference_cell(devices_.at(one.name), one.type, one.name, one.node));
    if (std::vector<kicad::Cell> spare = spare_contacts(); !spare.empty())
      board.cells.push_back(kicad::stacked(spare));
    board.cells.push_back(kicad::contact_supply_cell(switch_reference_, controller_.analog_switch.name));
    out.push_back(std::move(board));
    for (const Package& package : packages_) {
      const int per = package.type->per_package;
      kicad::Group power;
      power.cells.push_back(
          kicad::package_supply_cell(kicad::opamp_symbol(package.reference, package.type->name, per, per),
                                     {counter_.next("C"), counter_.next("C")}));
      for (int unit = package.used; unit < per; ++unit)
        power.cells.push_back(
            kicad::spare_opamp_cell(kicad::opamp_symbol(package.reference, package.type->name, per, unit)));
      out.push_back(std::move(power));
    }
    return out;
  }

 private:
  struct Package {
    std::string reference;
    const schematic::OpAmpModel* type = nullptr;
    int used = 0;
  };
  struct Place {
    std::string reference;
    const schematic::OpAmpModel* type = nullptr;
    int unit = 0;
  };

  std::string next_package() { return counter_.next("U"); }

  void place_opamp(const OpAmp& one) {
    const schematic::OpAmpModel& type = controller_.model_of(one);
    const auto open = std::find_if(packages_.begin(), packages_.end(), [&](const Package& package) {
      return package.type->name == type.name && package.used < type.per_package;
    });
    Package& package =
        open != packages_.end() ? *open : packages_.emplace_back(Package{next_package(), &type, 0});
    opamps_[one.name] = {package.reference, &type, package.used++};
  }

  /// Groups that have anything in them, the powers first.
  std::vector<std::size_t> sheet_order() const {
    std::set<std::size_t> used;
    for (const Part& one : controller_.parts) used.insert(one.group);
    for (const Multiplier& one : controller_.multipliers) used.insert(one.group);
    for (const Contact& one : controller_.contacts) used.insert(one.group);
    std::vector<std::size_t> out(used.begin(), used.end());
    std::stable_partition(out.begin(), out.end(), [&](std::size_t group) {
      return controller_.purpose_of(group) == Purpose::powers;
    });
    return out;
  }

  /// Nodes that something else than this section's resistors, capacitors and op-amps needs by name.
  std::set<std::string> named_outside(std::size_t group) const {
    std::set<std::string> out = {"r", "v"};
    for (const Part& one : controller_.parts) {
      if (one.group != group || one.kind == Part::Kind::diode) out.insert({one.from, one.to});
    }
    for (const OpAmp& one : controller_.opamps) {
      if (one.group != group) out.insert({one.plus, one.minus, one.out});
    }
    for (const Multiplier& one : controller_.multipliers) out.insert({one.x, one.y, one.z, one.out});
    for (const Contact& one : controller_.contacts) out.insert({one.from, one.to});
    for (const schematic::Source& one : controller_.sources) out.insert(one.node);
    return out;
  }

  kicad::Symbol texts_of(const Part& part) const {
    const bool resistor = part.kind == Part::Kind::resistor;
    kicad::Symbol out;
    out.reference = references_.at(part.name);
    out.value = kicad::kicad_value(part.realised);
    out.footprint = resistor                 ? "Resistor_SMD:R_0603_1608Metric"
                    : part.realised <= 10e-9 ? "Capacitor_SMD:C_0603_1608Metric"
                    : part.realised <= 100e-9
                        ? "Capacitor_SMD:C_1206_3216Metric"
                        : "Capacitor_THT:C_Rect_L7.2mm_W5.5mm_P5.00mm_FKS2_FKP2_MKS2_MKP2";
    const char* const unit = resistor ? " ohm" : " F";
    out.fields = {
        {"Netlist", part.name},
        {"Series", part.series},
        {"Tolerance",
         rounded_text(resistor ? tolerances_.resistor_percent : tolerances_.capacitor_percent) + "%"},
        {"Wanted", plain_number(part.wanted) + unit},
        {"Realised", plain_number(part.realised) + unit},
        {"Section", controller_.groups[part.group].title}};
    return out;
  }

  kicad::Group section(std::size_t group) {
    kicad::Group out;
    out.text = controller_.groups[group].title;
    std::vector<Part> parts;
    for (const Part& one : controller_.parts) {
      if (one.group == group && one.kind != Part::Kind::diode) parts.push_back(one);
    }
    std::vector<OpAmp> opamps;
    for (const OpAmp& one : controller_.opamps) {
      if (one.group == group) opamps.push_back(one);
    }
    for (const Multiplier& one : controller_.multipliers) {
      if (one.group == group)
        out.cells.push_back(kicad::multiplier_cell(devices_.at(one.name), controller_.multiplier.name,
                                                   one.name, one.x, one.y, one.z, one.out));
    }
    for (kicad::Cell& cell : kicad::stage_cells(
             parts, opamps, "", "", [&](const Part& part) { return texts_of(part); },
             [&](const OpAmp& one) {
               const Place& place = opamps_.at(one.name);
               kicad::Symbol symbol = kicad::opamp_symbol(place.reference, place.type->name,
                                                          place.type->per_package, place.unit);
               symbol.fields = {{"Netlist", one.name}, {"Section", out.text}};
               return symbol;
             },
             named_outside(group))) {
      // Pieces of a row meet by name: a section is no chain.
      cell.entry.reset();
      out.cells.push_back(std::move(cell));
    }
    std::vector<kicad::Cell> diodes;
    for (const Part& one : controller_.parts) {
      if (one.group == group && one.kind == Part::Kind::diode)
        diodes.push_back(kicad::diode_cell(references_.at(one.name), one.series, one.name, one.from, one.to));
    }
    add_columns(diodes, out);
    std::vector<kicad::Cell> contacts;
    for (const Contact& one : controller_.contacts) {
      if (one.group == group)
        contacts.push_back(kicad::contact_cell(switch_reference_, controller_.analog_switch.name, one.name,
                                               contact_units_.at(one.name), one.from, one.to, "so"));
    }
    add_columns(contacts, out);
    return out;
  }

  /// Small cells above each other in columns about as high as what stands beside them.
  static void add_columns(const std::vector<kicad::Cell>& cells, kicad::Group& into) {
    constexpr std::size_t kInColumn = 3;
    for (std::size_t first = 0; first < cells.size(); first += kInColumn) {
      const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = cells.begin() + static_cast<std::ptrdiff_t>(std::min(first + kInColumn, cells.size()));
      into.cells.push_back(kicad::stacked({begin, end}));
    }
  }

  /// Units 0 and 3 close at logic 1.
  int free_unit(bool rising) {
    for (const int unit : rising ? std::vector<int>{0, 3} : std::vector<int>{1, 2}) {
      if (used_units_.insert(unit).second) return unit;
    }
    throw std::logic_error("more contacts than the switch has");
  }

  std::vector<kicad::Cell> spare_contacts() {
    std::vector<kicad::Cell> out;
    for (int unit = 0; unit < 4; ++unit) {
      if (used_units_.insert(unit).second)
        out.push_back(kicad::contact_cell(switch_reference_, controller_.analog_switch.name, "spare", unit,
                                          "0", "0", "0"));
    }
    return out;
  }

  const AnalogController& controller_;
  const circuit::Tolerances tolerances_;
  std::vector<Package> packages_;
  std::map<std::string, Place> opamps_;
  std::map<std::string, std::string> devices_, references_;
  std::map<std::string, int> contact_units_;
  std::string switch_reference_;
  std::set<int> used_units_;
  schematic::ReferenceCounter counter_;
};

}  // namespace

void add_schematic(const AnalogController& controller, const std::string& title, OutputSet& out,
                   const std::filesystem::path& folder, const circuit::Tolerances& tolerances) {
  SchematicMaker maker(controller, tolerances);
  const kicad::Sheet sheet =
      kicad::add_one_sheet_project(maker.groups(), "controller", title,
                                   fmt::format("bodesmith {}; op-amps {}, slope detector {}", kVersion,
                                               controller.opamp.name, controller.fast_opamp.name),
                                   out, folder);
  out.add(folder / "controller.svg", kicad::sheet_svg(sheet, title));
}

}  // namespace bodesmith::controller
