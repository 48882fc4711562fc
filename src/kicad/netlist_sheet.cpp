#include "kicad/netlist_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/text.hpp"
#include "kicad/devices.hpp"
#include "kicad/schematic.hpp"
#include "kicad/sheet_rows.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/references.hpp"

namespace bodesmith::kicad {
namespace {

using schematic::Contact;
using schematic::Multiplier;
using schematic::Netlist;
using schematic::OpAmp;
using schematic::Part;
using schematic::plain_number;
using schematic::Purpose;

class SheetMaker {
 public:
  SheetMaker(const Netlist& netlist, const SheetOptions& options) : netlist_(netlist), options_(options) {
    const std::vector<std::string> references = schematic::part_references(netlist, counter_);
    for (std::size_t i = 0; i < references.size(); ++i) references_[netlist.parts[i].name] = references[i];
    for (const OpAmp& one : netlist.opamps) place_opamp(one);
    for (const Multiplier& one : netlist.multipliers) devices_[one.name] = next_package();
    for (const Contact& one : netlist.contacts) place_contact(one);
    for (const schematic::Source& one : netlist.sources) devices_[one.name] = next_package();
  }

  std::vector<Group> groups() {
    std::vector<Group> out;
    for (const std::size_t group : sheet_order()) out.push_back(section(group));
    Group board;
    board.text = "connectors, supplies, references";
    for (const std::string& port : options_.ports)
      board.cells.push_back(connector_cell(counter_.next("J"), port));
    board.cells.push_back(supply_connector_cell(counter_.next("J"), "VCC", "VEE"));
    board.cells.push_back(supply_connector_cell(counter_.next("J"), "V5P", "V5N"));
    for (const schematic::Source& one : netlist_.sources)
      board.cells.push_back(reference_cell(devices_.at(one.name), one.type, one.name, one.node));
    for (const SwitchPackage& package : switches_) {
      if (std::vector<Cell> spare = spare_contacts(package); !spare.empty())
        board.cells.push_back(stacked(spare));
      board.cells.push_back(contact_supply_cell(package.reference, netlist_.analog_switch.name));
    }
    out.push_back(std::move(board));
    for (const Package& package : packages_) {
      const int per = package.type->per_package;
      Group power;
      power.cells.push_back(package_supply_cell(opamp_symbol(package.reference, package.type->name, per, per),
                                                {counter_.next("C"), counter_.next("C")}));
      for (int unit = package.used; unit < per; ++unit)
        power.cells.push_back(
            spare_opamp_cell(opamp_symbol(package.reference, package.type->name, per, unit)));
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
    const schematic::OpAmpModel& type = netlist_.model_of(one);
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
    for (const Part& one : netlist_.parts) used.insert(one.group);
    for (const Multiplier& one : netlist_.multipliers) used.insert(one.group);
    for (const Contact& one : netlist_.contacts) used.insert(one.group);
    std::vector<std::size_t> out(used.begin(), used.end());
    std::stable_partition(out.begin(), out.end(),
                          [&](std::size_t group) { return netlist_.purpose_of(group) == Purpose::powers; });
    return out;
  }

  /// Nodes that something else than this section's resistors, capacitors and op-amps needs by name.
  std::set<std::string> named_outside(std::size_t group) const {
    std::set<std::string> out(options_.ports.begin(), options_.ports.end());
    for (const Part& one : netlist_.parts) {
      if (one.group != group || one.kind == Part::Kind::diode) out.insert({one.from, one.to});
    }
    for (const OpAmp& one : netlist_.opamps) {
      if (one.group != group) out.insert({one.plus, one.minus, one.out});
    }
    for (const Multiplier& one : netlist_.multipliers) out.insert({one.x, one.y, one.z, one.out});
    for (const Contact& one : netlist_.contacts) out.insert({one.from, one.to});
    for (const schematic::Source& one : netlist_.sources) out.insert(one.node);
    return out;
  }

  Symbol texts_of(const Part& part) const {
    const bool resistor = part.kind == Part::Kind::resistor;
    Symbol out;
    out.reference = references_.at(part.name);
    out.value = kicad_value(part.realised);
    out.footprint = resistor                 ? "Resistor_SMD:R_0603_1608Metric"
                    : part.realised <= 10e-9 ? "Capacitor_SMD:C_0603_1608Metric"
                    : part.realised <= 100e-9
                        ? "Capacitor_SMD:C_1206_3216Metric"
                        : "Capacitor_THT:C_Rect_L7.2mm_W5.5mm_P5.00mm_FKS2_FKP2_MKS2_MKP2";
    const char* const unit = resistor ? " ohm" : " F";
    out.fields = {{"Netlist", part.name},
                  {"Series", part.series},
                  {"Tolerance", rounded_text(resistor ? options_.tolerances.resistor_percent
                                                      : options_.tolerances.capacitor_percent) +
                                    "%"},
                  {"Wanted", plain_number(part.wanted) + unit},
                  {"Realised", plain_number(part.realised) + unit},
                  {"Section", netlist_.groups[part.group].title}};
    return out;
  }

  Group section(std::size_t group) {
    Group out;
    out.text = netlist_.groups[group].title;
    std::vector<Part> parts;
    for (const Part& one : netlist_.parts) {
      if (one.group == group && one.kind != Part::Kind::diode) parts.push_back(one);
    }
    std::vector<OpAmp> opamps;
    for (const OpAmp& one : netlist_.opamps) {
      if (one.group == group) opamps.push_back(one);
    }
    for (const Multiplier& one : netlist_.multipliers) {
      if (one.group == group)
        out.cells.push_back(multiplier_cell(devices_.at(one.name), netlist_.multiplier.name, one.name, one.x,
                                            one.y, one.z, one.out));
    }
    for (Cell& cell : stage_cells(
             parts, opamps, "", "", [&](const Part& part) { return texts_of(part); },
             [&](const OpAmp& one) {
               const Place& place = opamps_.at(one.name);
               Symbol symbol =
                   opamp_symbol(place.reference, place.type->name, place.type->per_package, place.unit);
               symbol.fields = {{"Netlist", one.name}, {"Section", out.text}};
               return symbol;
             },
             named_outside(group))) {
      // Pieces of a row meet by name: a section is no chain.
      cell.entry.reset();
      out.cells.push_back(std::move(cell));
    }
    std::vector<Cell> diodes;
    for (const Part& one : netlist_.parts) {
      if (one.group == group && one.kind == Part::Kind::diode)
        diodes.push_back(diode_cell(references_.at(one.name), one.series, one.name, one.from, one.to));
    }
    add_columns(diodes, out);
    std::vector<Cell> contacts;
    for (const Contact& one : netlist_.contacts) {
      if (one.group == group)
        contacts.push_back(contact_cell(contacts_.at(one.name).reference, netlist_.analog_switch.name,
                                        one.name, contacts_.at(one.name).unit, one.from, one.to,
                                        control_of(one.control)));
    }
    add_columns(contacts, out);
    return out;
  }

  /// Small cells above each other in columns about as high as what stands beside them.
  static void add_columns(const std::vector<Cell>& cells, Group& into) {
    constexpr std::size_t kInColumn = 3;
    for (std::size_t first = 0; first < cells.size(); first += kInColumn) {
      const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = cells.begin() + static_cast<std::ptrdiff_t>(std::min(first + kInColumn, cells.size()));
      into.cells.push_back(stacked({begin, end}));
    }
  }

  /// Units 0 and 3 close at logic 1, the others at 0: a contact of an even position closes on the rising way.
  void place_contact(const Contact& one) {
    const std::vector<int> units = one.position % 2 == 0 ? std::vector<int>{0, 3} : std::vector<int>{1, 2};
    for (std::size_t i = 0;; ++i) {
      if (i == switches_.size()) switches_.push_back({next_package(), {}});
      for (const int unit : units) {
        if (!switches_[i].used.insert(unit).second) continue;
        contacts_[one.name] = {switches_[i].reference, unit};
        return;
      }
    }
  }

  /// The node behind a level that follows one node alone.
  std::string control_of(std::string level) const {
    for (bool moved = true; moved;) {
      moved = false;
      const auto take = [&](const std::string& out, const std::string& in) {
        if (moved || out != level) return;
        level = in;
        moved = true;
      };
      for (const schematic::Comparator& one : netlist_.comparators) take(one.out, one.in);
      for (const schematic::Gate& one : netlist_.gates) {
        if (one.high.size() + one.low.size() == 1) take(one.out, one.high.empty() ? one.low[0] : one.high[0]);
      }
    }
    return level;
  }

  struct SwitchPackage {
    std::string reference;
    std::set<int> used;
  };
  struct ContactPlace {
    std::string reference;
    int unit = 0;
  };

  std::vector<Cell> spare_contacts(const SwitchPackage& package) const {
    std::vector<Cell> out;
    for (int unit = 0; unit < 4; ++unit) {
      if (!package.used.contains(unit))
        out.push_back(
            contact_cell(package.reference, netlist_.analog_switch.name, "spare", unit, "0", "0", "0"));
    }
    return out;
  }

  const Netlist& netlist_;
  const SheetOptions& options_;
  std::vector<Package> packages_;
  std::vector<SwitchPackage> switches_;
  std::map<std::string, Place> opamps_;
  std::map<std::string, ContactPlace> contacts_;
  std::map<std::string, std::string> devices_, references_;
  schematic::ReferenceCounter counter_;
};

}  // namespace

void add_netlist_project(const Netlist& netlist, const SheetOptions& options, OutputSet& out,
                         const std::filesystem::path& folder) {
  SheetMaker maker(netlist, options);
  const Sheet sheet =
      add_one_sheet_project(maker.groups(), options.stem, options.title, options.comment, out, folder);
  out.add(folder / (options.stem + ".svg"), sheet_svg(sheet, options.title));
}

std::string netlist_svg(const Netlist& netlist, const SheetOptions& options) {
  SheetMaker maker(netlist, options);
  return sheet_svg(one_sheet(maker.groups(), options.stem), options.title);
}

}  // namespace bodesmith::kicad
