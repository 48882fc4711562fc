#include "schematic/writers/kicad/netlist_groups.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/writers/kicad/devices.hpp"

namespace bodesmith::kicad {
namespace {

using schematic::Contact;
using schematic::Multiplier;
using schematic::Netlist;
using schematic::OpAmp;
using schematic::Part;
using schematic::plain_number;
using schematic::Purpose;

/// Sizes in which stable dielectrics (C0G to 100 nF, film above) are sold.
const char* capacitor_footprint(double farad) {
  if (farad <= 10e-9) return "Capacitor_SMD:C_0603_1608Metric";
  if (farad <= 100e-9) return "Capacitor_SMD:C_1206_3216Metric";
  if (farad <= 220e-9) return "Capacitor_SMD:C_1210_3225Metric";
  return "Capacitor_THT:C_Rect_L7.2mm_W5.5mm_P5.00mm_FKS2_FKP2_MKS2_MKP2";
}

/// References as a board's drawing and its parts list number them (IEEE 315): the letter of the kind, then the
/// part's place among its kind: R1, R2, C1, D1, U1.
class ReferenceCounter {
 public:
  std::string next(const std::string& letter) { return letter + std::to_string(++count_[letter]); }

 private:
  std::map<std::string, int> count_;
};

/// Of Netlist::parts, one by one in their order.
std::vector<std::string> part_references(const Netlist& netlist, ReferenceCounter& counter) {
  std::vector<std::string> out;
  for (const Part& part : netlist.parts)
    out.push_back(counter.next(part.kind == Part::Kind::resistor    ? "R"
                               : part.kind == Part::Kind::capacitor ? "C"
                                                                    : "D"));
  return out;
}

class GroupMaker {
 public:
  GroupMaker(const Netlist& netlist, const std::vector<std::string>& ports,
             const std::vector<ChainStage>& chain)
      : netlist_(netlist), ports_(ports), chain_(chain) {
    const std::vector<std::string> references = part_references(netlist, counter_);
    for (std::size_t i = 0; i < references.size(); ++i) references_[netlist.parts[i].name] = references[i];
    for (const OpAmp& one : netlist.opamps) place_opamp(one);
    for (const Multiplier& one : netlist.multipliers) devices_[one.name] = next_package();
    for (const Contact& one : netlist.contacts) place_contact(one);
    for (const schematic::Source& one : netlist.sources) devices_[one.name] = next_package();
  }

  NetlistGroups groups() {
    NetlistGroups out;
    for (const std::size_t group : sheet_order()) out.sections.push_back(section(group));
    Group connectors;
    connectors.text = netlist_.sources.empty() ? "connectors, supplies, 100 nF at every supply pin"
                                               : "connectors, supplies, references";
    for (const std::string& port : ports_)
      connectors.cells.push_back(connector_cell(counter_.next("J"), port));
    connectors.cells.push_back(supply_connector_cell(counter_.next("J"), "VCC", "VEE"));
    if (!netlist_.multipliers.empty())
      connectors.cells.push_back(supply_connector_cell(counter_.next("J"), "V5P", "V5N"));
    for (const schematic::Source& one : netlist_.sources)
      connectors.cells.push_back(reference_cell(devices_.at(one.name), one.type, one.name, one.node));
    for (const SwitchPackage& package : switches_) {
      if (std::vector<Cell> spare = spare_contacts(package); !spare.empty())
        connectors.cells.push_back(stacked(spare));
      connectors.cells.push_back(contact_supply_cell(package.reference, netlist_.analog_switch.name));
    }
    out.board.push_back(std::move(connectors));
    for (const Package& package : packages_) {
      const int per = package.type->per_package;
      Group power;
      power.cells.push_back(package_supply_cell(opamp_symbol(package.reference, package.type->name, per, per),
                                                {counter_.next("C"), counter_.next("C")}));
      for (int unit = package.used; unit < per; ++unit)
        power.cells.push_back(
            spare_opamp_cell(opamp_symbol(package.reference, package.type->name, per, unit)));
      out.board.push_back(std::move(power));
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
    const auto open = std::ranges::find_if(packages_, [&](const Package& package) {
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
    std::set<std::string> out(ports_.begin(), ports_.end());
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
    out.footprint = resistor ? "Resistor_SMD:R_0603_1608Metric" : capacitor_footprint(part.realised);
    const char* const unit = resistor ? " ohm" : " F";
    out.fields = {{"Netlist", part.name},
                  {"Series", part.series},
                  {"Tolerance", rounded_text(resistor ? netlist_.tolerances.resistor_percent
                                                      : netlist_.tolerances.capacitor_percent) +
                                    "%"},
                  {"Wanted", plain_number(part.wanted) + unit},
                  {"Realised", plain_number(part.realised) + unit},
                  {"Section", section_name(part.group)}};
    return out;
  }

  /// A stage's number, or a group's title.
  std::string section_name(std::size_t group) const {
    return chain_.empty() ? netlist_.groups[group].title : std::to_string(group + 1);
  }

  Group section(std::size_t group) {
    Group out;
    const ChainStage stage =
        chain_.empty() ? ChainStage{"", "", netlist_.groups[group].title} : chain_[group];
    out.in = stage.in;
    out.out = stage.out;
    out.text = stage.text;
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
             parts, opamps, stage.in, stage.out, [&](const Part& part) { return texts_of(part); },
             [&](const OpAmp& one) {
               const Place& place = opamps_.at(one.name);
               Symbol symbol =
                   opamp_symbol(place.reference, place.type->name, place.type->per_package, place.unit);
               symbol.fields = {{"Netlist", one.name}, {"Section", section_name(group)}};
               return symbol;
             },
             chain_.empty() ? named_outside(group) : std::set<std::string>())) {
      // Pieces of a row meet by name where a section is no stage of a chain.
      if (chain_.empty()) cell.entry.reset();
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

  /// Small cells above each other in columns about as high as what stands next to them.
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
  const std::vector<std::string>& ports_;
  const std::vector<ChainStage>& chain_;
  std::vector<Package> packages_;
  std::vector<SwitchPackage> switches_;
  std::map<std::string, Place> opamps_;
  std::map<std::string, ContactPlace> contacts_;
  std::map<std::string, std::string> devices_, references_;
  ReferenceCounter counter_;
};

}  // namespace

NetlistGroups netlist_groups(const Netlist& netlist, const std::vector<std::string>& ports,
                             const std::vector<ChainStage>& chain) {
  return GroupMaker(netlist, ports, chain).groups();
}

std::string kicad_value(double value) {
  static const std::map<int, const char*> kPrefixes = {
      {-15, "f"}, {-12, "p"}, {-9, "n"}, {-6, "u"}, {-3, "m"}, {0, ""}, {3, "k"}, {6, "M"}, {9, "G"}};
  const int power =
      std::clamp(3 * whole_number<int>(std::floor(std::log10(value) / 3.0 + 1e-9), -110, 110), -15, 9);
  return rounded_text(value / std::pow(10.0, power), 6) + kPrefixes.at(power);
}

}  // namespace bodesmith::kicad
