#include <algorithm>
#include <set>
#include <stdexcept>

#include "part_errors/rest_point.hpp"

namespace bodesmith::part_errors {

using controller::AnalogController;
using schematic::Part;

Wiring::Wiring(const AnalogController& controller) : controller_(controller) {
  names_ = {{"0", kGround}, {"r", kReference}, {"v", kDrive}, {"sn", kSlope}};
  std::vector<Element> all;
  collect(all);
  collect_dividers(all);
  order(std::move(all));
}

int Wiring::number(const std::string& name) {
  const auto [at, fresh] = names_.try_emplace(name, static_cast<int>(count_));
  if (fresh) ++count_;
  return at->second;
}

/// What makes v is not what reads it: the loop is cut there.
int Wiring::output_number(const std::string& name) {
  return name == "v" ? kMade : number(name);
}

int Wiring::node(const std::string& name) const {
  const auto at = names_.find(name);
  return at == names_.end() ? -1 : at->second;
}

void Wiring::collect(std::vector<Element>& out) {
  const AnalogController& c = controller_;
  for (std::size_t i = 0; i < c.sums.size(); ++i) {
    // The slope meter's sum makes sn, which is forced.
    if (c.slope && c.slope->full_wave == static_cast<int>(i)) continue;
    Element e{Element::Kind::sum, {}, output_number(c.op(c.sums[i].opamp).out), static_cast<int>(i)};
    for (const controller::Term& term : c.sums[i].terms) e.in.push_back(number(term.node));
    out.push_back(std::move(e));
  }
  for (std::size_t i = 0; i < c.rectifiers.size(); ++i) {
    Element e{Element::Kind::rectifier, {}, number(c.rectifiers[i].node), static_cast<int>(i)};
    for (const controller::Term& term : c.rectifiers[i].terms) e.in.push_back(number(term.node));
    out.push_back(std::move(e));
  }
  for (std::size_t i = 0; i < c.multipliers.size(); ++i) {
    const schematic::Multiplier& m = c.multipliers[i];
    out.push_back({Element::Kind::multiplier,
                   {number(m.x), number(m.y), number(m.z)},
                   number(m.out),
                   static_cast<int>(i)});
  }
  for (std::size_t i = 0; i < c.opamps.size(); ++i) {
    const schematic::OpAmp& u = c.opamps[i];
    if (u.minus != u.out) continue;
    out.push_back({Element::Kind::follower, {number(u.plus)}, output_number(u.out), static_cast<int>(i)});
  }
  std::map<std::string, Element> contacts;
  for (const schematic::Contact& contact : c.contacts) {
    Element& e = contacts[contact.to];
    e.kind = Element::Kind::contact;
    e.in.resize(2, kGround);
    e.in[contact.position == 0 ? 0 : 1] = number(contact.from);
    e.out = number(contact.to);
  }
  for (auto& [to, e] : contacts) out.push_back(std::move(e));
}

/// A node that nothing drives and that two resistors meet, where an op-amp's other input or a multiplier reads.
void Wiring::collect_dividers(std::vector<Element>& out) {
  std::set<int> driven = {kGround, kReference, kDrive, kSlope};
  for (const Element& e : out) driven.insert(e.out);
  for (const schematic::Source& one : controller_.sources) driven.insert(number(one.node));
  std::set<std::string> wanted;
  for (const Element& e : out) {
    for (const int in : e.in) {
      if (driven.count(in) > 0) continue;
      for (const auto& [name, index] : names_) {
        if (index == in) wanted.insert(name);
      }
    }
  }
  for (const std::string& name : wanted) {
    std::vector<int> touching;
    for (std::size_t i = 0; i < controller_.parts.size(); ++i) {
      const Part& part = controller_.parts[i];
      if (part.kind == Part::Kind::resistor && (part.from == name || part.to == name))
        touching.push_back(static_cast<int>(i));
    }
    if (touching.size() != 2)
      throw std::logic_error("node " + name + " of the controller is driven by nothing");
    Element e{Element::Kind::divider, {}, number(name), touching[0], touching[1]};
    for (const int i : touching) {
      const Part& part = controller_.part(i);
      e.in.push_back(number(part.from == name ? part.to : part.from));
    }
    out.push_back(std::move(e));
  }
}

void Wiring::order(std::vector<Element> all) {
  // What follows from the slope and the references alone is the gain curve.
  std::set<int> still = {kGround, kSlope};
  for (const schematic::Source& one : controller_.sources) still.insert(number(one.node));
  std::set<int> known = still;
  known.insert({kReference, kDrive});
  const auto place = [&](std::set<int>& from, std::vector<Element>& into) {
    for (bool moved = true; moved;) {
      moved = false;
      for (auto e = all.begin(); e != all.end();) {
        const bool ready =
            std::all_of(e->in.begin(), e->in.end(), [&](int in) { return from.count(in) > 0; });
        if (ready) {
          from.insert(e->out);
          known.insert(e->out);
          into.push_back(std::move(*e));
          e = all.erase(e);
          moved = true;
        } else {
          ++e;
        }
      }
    }
  };
  place(still, rate_);
  place(known, generator_);
  if (!all.empty()) throw std::logic_error("the controller's voltages do not follow from one another");
}

}  // namespace bodesmith::part_errors
