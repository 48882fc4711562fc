#include "schematic/kicad_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "base/files.hpp"

namespace bodesmith {
namespace {

struct Expression {
  std::string atom;
  bool quoted = false;
  std::vector<Expression> items;

  const std::string& head() const { return items.at(0).atom; }
  const std::string& text(size_t i) const { return items.at(i).atom; }
  double number(size_t i) const {
    char* end = nullptr;
    const double out = std::strtod(text(i).c_str(), &end);
    if (end == text(i).c_str() || *end != '\0') throw std::runtime_error("not a number: " + text(i));
    return out;
  }
  std::vector<const Expression*> all(const std::string& name) const {
    std::vector<const Expression*> out;
    for (const Expression& one : items) {
      if (!one.items.empty() && one.head() == name) out.push_back(&one);
    }
    return out;
  }
  const Expression* find(const std::string& name) const {
    const auto found = all(name);
    return found.empty() ? nullptr : found[0];
  }
  const Expression& get(const std::string& name) const {
    const Expression* found = find(name);
    if (found == nullptr) throw std::runtime_error("no " + name);
    return *found;
  }
};

Expression parse(const std::string& text, size_t& at) {
  const auto space = [&] {
    while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])) != 0) ++at;
  };
  Expression out;
  if (text.at(at) == '(') {
    ++at;
    for (space(); text.at(at) != ')'; space()) out.items.push_back(parse(text, at));
    ++at;
    if (out.items.empty()) throw std::runtime_error("an empty list");
    return out;
  }
  if (text[at] == '"') {
    out.quoted = true;
    for (++at; text.at(at) != '"'; ++at) {
      if (text[at] == '\\') ++at;
      out.atom += text.at(at);
    }
    ++at;
    return out;
  }
  while (at < text.size() && text[at] != ')' && text[at] != '(' &&
         std::isspace(static_cast<unsigned char>(text[at])) == 0)
    out.atom += text[at++];
  return out;
}

using Place = std::pair<long, long>;  // 0.01 mm

Place place(double x, double y) {
  return {std::lround(x * 100.0), std::lround(y * 100.0)};
}

class Reader {
 public:
  Reader(std::string folder, KicadSchematic& out) : folder_(std::move(folder)), out_(out) {}

  void read(const std::string& root) {
    sheet(root, "", {});
    for (size_t i = 0; i < parent_.size(); ++i) {
      for (const std::string& name : net_names_[i]) by_name_[name].push_back(static_cast<int>(i));
    }
    for (const auto& [name, nets] : by_name_) {
      for (const int net : nets) join(nets[0], net);
    }
    for (size_t i = 0; i < parent_.size(); ++i)
      out_.names[root_of(static_cast<int>(i))].insert(net_names_[i].begin(), net_names_[i].end());
    for (auto& [reference, component] : out_.components) {
      for (auto& [pin, net] : component.pin_nets) net = root_of(net);
    }
  }

 private:
  int make_net() {
    parent_.push_back(static_cast<int>(parent_.size()));
    net_names_.emplace_back();
    return parent_.back();
  }
  int root_of(int net) const {
    while (parent_[static_cast<size_t>(net)] != net) net = parent_[static_cast<size_t>(net)];
    return net;
  }
  void join(int a, int b) { parent_[static_cast<size_t>(root_of(a))] = root_of(b); }

  /// `ports`: nets of the box's pins.
  void sheet(const std::string& file, const std::string& path, const std::map<std::string, int>& ports) {
    if (++out_.sheets > 50) throw std::runtime_error("sheets without end");
    const std::string text = read_file(folder_ + "/" + file);
    size_t at = 0;
    const Expression top = parse(text, at);
    if (top.head() != "kicad_sch" || top.get("version").text(1) != "20211123")
      throw std::runtime_error("not a schematic of KiCad 6");
    const std::string paper = top.get("paper").text(1);
    const std::map<std::string, Place> sizes = {{"A4", {29700, 21000}},
                                                {"A3", {42000, 29700}},
                                                {"A2", {59400, 42000}},
                                                {"A1", {84100, 59400}},
                                                {"A0", {118900, 84100}}};
    const Place size = sizes.at(paper);

    std::map<Place, int> nets;
    std::map<Place, int> met;  // wire ends and pins
    const auto net_at = [&](Place p) {
      if (p.first < 1000 || p.second < 1000 || p.first > size.first - 1000 || p.second > size.second - 1000)
        out_.off_page = true;
      const auto [found, is_new] = nets.try_emplace(p, 0);
      if (is_new) found->second = make_net();
      return found->second;
    };
    // KiCad joins what meets at ends; a wire's inside only where a junction stands on it.
    struct Segment {
      Place a, b;
    };
    std::vector<Segment> wires;
    for (const Expression* wire : top.all("wire")) {
      const auto points = wire->get("pts").all("xy");
      const Segment one{place(points.at(0)->number(1), points.at(0)->number(2)),
                        place(points.at(1)->number(1), points.at(1)->number(2))};
      wires.push_back(one);
      join(net_at(one.a), net_at(one.b));
      ++met[one.a];
      ++met[one.b];
    }
    const auto on = [](const Segment& s, Place p) {
      const long cross = (s.b.first - s.a.first) * (p.second - s.a.second) -
                         (s.b.second - s.a.second) * (p.first - s.a.first);
      return cross == 0 && p.first >= std::min(s.a.first, s.b.first) &&
             p.first <= std::max(s.a.first, s.b.first) && p.second >= std::min(s.a.second, s.b.second) &&
             p.second <= std::max(s.a.second, s.b.second);
    };
    const auto onto_wires = [&](Place p) {
      for (const Segment& wire : wires) {
        if (on(wire, p)) join(net_at(p), net_at(wire.a));
      }
    };
    for (const Expression* junction : top.all("junction"))
      onto_wires(place(junction->get("at").number(1), junction->get("at").number(2)));
    for (const char* kind : {"label", "hierarchical_label"}) {
      for (const Expression* label : top.all(kind)) {
        const Place p = place(label->get("at").number(1), label->get("at").number(2));
        onto_wires(p);
        ++met[p];
        const int net = net_at(p);
        net_names_[static_cast<size_t>(net)].insert(path + label->text(1));
        if (kind == std::string("hierarchical_label")) join(net, ports.at(label->text(1)));
      }
    }
    symbols(top, net_at, met);
    for (const Expression* box : top.all("sheet")) {
      std::map<std::string, int> pins;
      std::string name;
      for (const Expression* pin : box->all("pin")) {
        const Place p = place(pin->get("at").number(1), pin->get("at").number(2));
        ++met[p];
        pins[pin->text(1)] = net_at(p);
      }
      for (const Expression* property : box->all("property")) {
        if (property->text(1) == "Sheet file") name = property->text(2);
      }
      sheet(name, path + name + "/", pins);
    }
    for (const auto& [p, count] : met) out_.dangling_ends += count < 2 ? 1 : 0;
  }

  struct Box {
    std::string of;
    double left, right, low, high;
  };

  template <class NetAt>
  void symbols(const Expression& top, NetAt net_at, std::map<Place, int>& met) {
    std::map<std::string, const Expression*> library;
    for (const Expression* symbol : top.get("lib_symbols").all("symbol")) library[symbol->text(1)] = symbol;
    std::set<Place> texts;
    std::vector<Box> bodies;
    for (const Expression* symbol : top.all("symbol")) {
      const std::string& id = symbol->get("lib_id").text(1);
      const Expression& drawn = *library.at(id);
      const int unit = static_cast<int>(symbol->get("unit").number(1));
      const double x = symbol->get("at").number(1), y = symbol->get("at").number(2),
                   angle = symbol->get("at").number(3) * std::acos(-1.0) / 180.0;
      const Expression* mirror = symbol->find("mirror");
      std::map<std::string, std::string> fields;
      for (const Expression* property : symbol->all("property")) {
        fields[property->text(1)] = property->text(2);
        const bool hidden = property->get("effects").items.back().atom == "hide";
        if (hidden) continue;
        if (!texts.insert(place(property->get("at").number(1), property->get("at").number(2))).second)
          ++out_.stacked_texts;
      }
      const std::string reference = fields.at("Reference");
      const bool supply = drawn.find("power") != nullptr;
      KicadSchematic::Component* component = supply ? nullptr : &out_.components[reference];
      if (component != nullptr) {
        component->value = fields.at("Value");
        component->footprint = fields.at("Footprint");
        for (const auto& [name, value] : fields) {
          // Units of one package carry the same names: kept apart by the unit.
          component->fields[name] = value;
          component->fields[name + "@" + std::to_string(unit)] = value;
        }
      }
      std::set<std::string> listed;
      for (const Expression* pin : symbol->all("pin")) listed.insert(pin->text(1));
      const std::string name = id.substr(id.find(':') + 1);
      bool found_unit = false;
      for (const Expression* part : drawn.all("symbol")) {
        if (part->text(1) != name + "_" + std::to_string(unit) + "_1") continue;
        found_unit = true;
        std::vector<std::pair<double, double>> corners;
        points_of(*part, corners);
        if (!supply && !corners.empty()) {
          Box body{reference, 1e9, -1e9, 1e9, -1e9};
          for (const auto& [px, y_up] : corners) {
            const double py = y_up * (mirror != nullptr ? -1.0 : 1.0);
            const double tx = px * std::cos(angle) - py * std::sin(angle),
                         ty = px * std::sin(angle) + py * std::cos(angle);
            body.left = std::min(body.left, x + tx), body.right = std::max(body.right, x + tx);
            body.low = std::min(body.low, y - ty), body.high = std::max(body.high, y - ty);
          }
          for (const Box& other : bodies) {
            const double across = std::min(body.right, other.right) - std::max(body.left, other.left);
            const double down = std::min(body.high, other.high) - std::max(body.low, other.low);
            out_.overlaps += across > 0.01 && down > 0.01 ? 1 : 0;
          }
          bodies.push_back(body);
        }
        for (const Expression* pin : part->all("pin")) {
          // Library: y upwards. Mirrored about the x axis first, then turned counter-clockwise.
          const double px = pin->get("at").number(1);
          const double py = pin->get("at").number(2) * (mirror != nullptr ? -1.0 : 1.0);
          const double tx = px * std::cos(angle) - py * std::sin(angle);
          const double ty = px * std::sin(angle) + py * std::cos(angle);
          const Place p = place(x + tx, y - ty);
          ++met[p];
          const std::string& number = pin->get("number").text(1);
          if (!listed.erase(number)) throw std::runtime_error(reference + " does not list pin " + number);
          const int net = net_at(p);
          if (component != nullptr) {
            if (!component->pin_nets.emplace(number, net).second)
              throw std::runtime_error(reference + " has pin " + number + " twice");
          } else if (id != "bodesmith:PWR_FLAG") {
            net_names_[static_cast<size_t>(net)].insert(fields.at("Value"));
          }
        }
      }
      if (!found_unit || !listed.empty()) throw std::runtime_error(reference + " lists pins it has not");
    }
  }

  /// Of what is drawn, pins and texts left out.
  static void points_of(const Expression& drawn, std::vector<std::pair<double, double>>& out) {
    for (const Expression& one : drawn.items) {
      if (one.items.empty()) continue;
      if (one.head() == "xy" || one.head() == "start" || one.head() == "end") {
        out.emplace_back(one.number(1), one.number(2));
      } else if (one.head() == "polyline" || one.head() == "rectangle" || one.head() == "pts") {
        points_of(one, out);
      }
    }
  }

  std::string folder_;
  KicadSchematic& out_;
  std::vector<int> parent_;
  std::vector<std::set<std::string>> net_names_;
  std::map<std::string, std::vector<int>> by_name_;
};

}  // namespace

namespace {

double value_of(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const std::map<std::string, double> prefixes = {{"", 1.0},   {"f", 1e-15}, {"p", 1e-12},
                                                  {"n", 1e-9}, {"u", 1e-6},  {"m", 1e-3},
                                                  {"k", 1e3},  {"M", 1e6},   {"G", 1e9}};
  return number * prefixes.at(end);
}

}  // namespace

void expect_joined(const KicadSchematic& schematic, const KicadNetlist& netlist,
                   const std::map<std::string, std::string>& references, double tolerance) {
  EXPECT_FALSE(netlist.parts.empty());
  EXPECT_EQ(schematic.dangling_ends, 0);
  EXPECT_EQ(schematic.stacked_texts, 0);
  EXPECT_EQ(schematic.overlaps, 0);
  EXPECT_FALSE(schematic.off_page);

  std::map<std::string, int> net_of;
  std::map<int, std::string> node_of;
  const auto same = [&](const std::string& node, int net, const std::string& where) {
    const int known = net_of.try_emplace(node, net).first->second;
    const std::string& other = node_of.try_emplace(net, node).first->second;
    EXPECT_EQ(known, net) << where << ": node " << node << " is in two pieces";
    EXPECT_EQ(other, node) << where << ": two nodes are joined";
  };
  std::set<std::string> parts_drawn;
  for (const auto& [name, part] : netlist.parts) {
    if (!references.contains(name) || !schematic.components.contains(references.at(name))) {
      ADD_FAILURE() << name << " is not drawn";
      continue;
    }
    const auto& drawn = schematic.components.at(references.at(name));
    parts_drawn.insert(references.at(name));
    EXPECT_EQ(drawn.fields.at("Netlist"), name);
    EXPECT_LE(std::abs(value_of(drawn.value) / part.value - 1.0), tolerance + 1e-12) << name << drawn.value;
    EXPECT_FALSE(drawn.footprint.empty()) << name;
    for (const char* field : {"Series", "Tolerance", "Wanted", "Realised", "Section"})
      EXPECT_TRUE(drawn.fields.contains(field) && !drawn.fields.at(field).empty()) << name << field;
    EXPECT_EQ(drawn.pin_nets.size(), 2U) << name;
  }
  // Op-amps first: their pins tell nodes apart, so that a part's two pins can be told apart too.
  std::set<std::string> packages;
  for (const auto& [name, opamp] : netlist.opamps) {
    bool found = false;
    for (const auto& [reference, drawn] : schematic.components) {
      for (const int unit : {1, 2}) {
        const auto field = drawn.fields.find("Netlist@" + std::to_string(unit));
        if (field == drawn.fields.end() || field->second != name) continue;
        found = true;
        packages.insert(reference);
        const bool dual = drawn.pin_nets.contains("8");
        const char* const plus = unit == 2 ? "5" : "3";
        const char* const minus = unit == 2 ? "6" : "2";
        const char* const output = dual ? (unit == 2 ? "7" : "1") : "6";
        same(opamp.nodes[0], drawn.pin_nets.at(plus), name);
        same(opamp.nodes[1], drawn.pin_nets.at(minus), name);
        same(opamp.nodes[2], drawn.pin_nets.at(output), name);
        const char* const positive = dual ? "8" : "7";
        EXPECT_TRUE(schematic.names.at(drawn.pin_nets.at(positive)).contains("VCC")) << reference;
        EXPECT_TRUE(schematic.names.at(drawn.pin_nets.at("4")).contains("VEE")) << reference;
      }
    }
    EXPECT_TRUE(found) << name << " is not drawn";
  }
  // Names tell the rest: every net has at most one, the node's own.
  for (const auto& [net, names] : schematic.names) {
    std::set<std::string> plain;
    for (const std::string& name : names) plain.insert(name.substr(name.find_last_of('/') + 1));
    if (plain.empty()) continue;
    EXPECT_EQ(plain.size(), 1U) << *plain.begin() << " and " << *plain.rbegin() << " are one net";
    const std::string node = *plain.begin() == "GND" ? "0" : *plain.begin();
    if (node != "VCC" && node != "VEE") same(node, net, "label");
  }
  // Parts: by what is known of their nodes, until nothing new is learnt.
  for (size_t pass = 0; pass <= netlist.parts.size(); ++pass) {
    for (const auto& [name, part] : netlist.parts) {
      if (!references.contains(name) || !schematic.components.contains(references.at(name))) continue;
      const auto& pins = schematic.components.at(references.at(name)).pin_nets;
      const int a = pins.at("1"), b = pins.at("2");
      const std::string &p = part.nodes[0], &q = part.nodes[1];
      const auto is = [&](const std::string& node, int net) {
        return net_of.contains(node) && net_of.at(node) == net;
      };
      if (is(p, a) || is(q, b)) {
        same(p, a, name);
        same(q, b, name);
      } else if (is(p, b) || is(q, a)) {
        same(p, b, name);
        same(q, a, name);
      } else {
        EXPECT_LT(pass, netlist.parts.size()) << name << " is connected to nothing known";
      }
    }
  }
  EXPECT_EQ(parts_drawn.size(), netlist.parts.size());
  // Nothing else but what a board needs.
  size_t extra = 0;
  for (const auto& [reference, drawn] : schematic.components) {
    if (parts_drawn.contains(reference) || packages.contains(reference)) continue;
    ++extra;
    EXPECT_TRUE(reference.starts_with("J") || drawn.value == "100n") << reference;
  }
  // Numbered without a gap: as many as there are of each letter.
  for (const char* letter : {"R", "C", "U", "J"}) {
    const auto has = [&](const std::string& name) { return schematic.components.contains(name); };
    const auto count = std::count_if(schematic.components.begin(), schematic.components.end(),
                                     [&](const auto& one) { return one.first.starts_with(letter); });
    EXPECT_TRUE(count == 0 || (has(letter + std::string("1")) && has(letter + std::to_string(count))))
        << letter;
  }
  EXPECT_EQ(extra, 3 + 2 * packages.size());
}

KicadSchematic read_kicad(const std::string& folder, const std::string& root) {
  KicadSchematic out;
  Reader(folder, out).read(root);
  return out;
}

std::map<std::string, std::string> read_references(const std::string& path) {
  std::istringstream text(read_file(path));
  std::map<std::string, std::string> out;
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "quantity,references,value,tolerance,footprint,netlist");
  while (std::getline(text, line)) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == ',') cells.emplace_back();
      if (c != ',') cells.back() += c;
    }
    EXPECT_EQ(cells.size(), 6u) << line;
    std::istringstream references(cells.at(1));
    std::istringstream names(cells.at(5));
    int quantity = 0;
    for (std::string reference, units; references >> reference && names >> units; ++quantity) {
      std::replace(units.begin(), units.end(), '+', ' ');
      std::istringstream each(units);
      for (std::string name; each >> name;) {
        if (name != "-") out[name] = reference;
      }
    }
    EXPECT_EQ(std::to_string(quantity), cells.at(0)) << line;
  }
  return out;
}

}  // namespace bodesmith
