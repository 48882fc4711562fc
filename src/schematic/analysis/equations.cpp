#include "schematic/analysis/equations.hpp"

#include <algorithm>
#include <stdexcept>

namespace bodesmith::schematic {

Equations::Equations(const Netlist& netlist, const Assumptions& assumptions) : input_(assumptions.input) {
  for (const Part& part : netlist.parts) number(part.from), number(part.to);
  for (const OpAmp& one : netlist.opamps) number(one.plus), number(one.minus), number(one.out);
  for (const Multiplier& one : netlist.multipliers)
    number(one.x), number(one.y), number(one.z), number(one.out);
  for (const Contact& one : netlist.contacts) number(one.from), number(one.to);
  for (const Source& one : netlist.sources) number(one.node);
  if (assumptions.switching) {
    for (const Comparator& one : netlist.comparators) number(one.in), number(one.out);
    for (const Gate& one : netlist.gates) number(one.out);
  }
  count_ = nodes_.size();
  std::size_t ideal_diode = count_ + netlist.opamps.size();  // their rows come behind the op-amps'
  const Deviations* off = assumptions.off;
  for (std::size_t i = 0; i < netlist.parts.size(); ++i) {
    const Part& part = netlist.parts[i];
    const int from = node(part.from), to = node(part.to);
    const double value = off != nullptr ? off->value(netlist, static_cast<int>(i)) : part.realised;
    switch (part.kind) {
      case Part::Kind::resistor:
        elements_.push_back(make_resistor(from, to, value));
        break;
      case Part::Kind::capacitor:
        elements_.push_back(make_capacitor(from, to, value));
        break;
      case Part::Kind::diode:
        elements_.push_back(assumptions.ideal_diodes
                                ? make_ideal_diode(from, to, static_cast<int>(ideal_diode++))
                                : make_diode(from, to, netlist.diode));
        break;
    }
  }
  add_opamps(netlist, assumptions);
  count_ = ideal_diode;
  for (std::size_t i = 0; i < netlist.multipliers.size(); ++i) {
    const Multiplier& one = netlist.multipliers[i];
    elements_.push_back(make_multiplier({node(one.x), node(one.y), node(one.z), node(one.out)}, hold(one.out),
                                        netlist.multiplier,
                                        off != nullptr ? off->multiplier[i] : MultiplierDeviation{}));
  }
  if (!assumptions.switching) add_contacts(netlist, assumptions);
  for (std::size_t i = 0; i < netlist.sources.size(); ++i) {
    const Source& one = netlist.sources[i];
    if (one.node == input_) continue;
    const double volts = one.volts * (1.0 + (off != nullptr ? off->source[i] : 0.0));
    elements_.push_back(make_source(node(one.node), hold(one.node), volts));
  }
  if (assumptions.switching) add_levels(netlist), add_contacts(netlist, assumptions);
  linearise(std::vector<double>(count_, 0.0), 0.0);
}

void Equations::add_opamps(const Netlist& netlist, const Assumptions& assumptions) {
  for (std::size_t i = 0; i < netlist.opamps.size(); ++i) {
    const OpAmp& one = netlist.opamps[i];
    const Inputs at{node(one.plus), node(one.minus), node(one.out)};
    const double offset = assumptions.off != nullptr ? assumptions.off->opamp_offset_v[i] : 0.0;
    const int branch = static_cast<int>(count_++);
    elements_.push_back(assumptions.ideal_opamps ? make_nullor(at, branch, offset)
                                                 : make_opamp(at, branch, netlist.model_of(one), offset));
  }
}

void Equations::add_contacts(const Netlist& netlist, const Assumptions& assumptions) {
  const SwitchModel model =
      assumptions.off != nullptr ? assumptions.off->contact(netlist.analog_switch) : netlist.analog_switch;
  for (const Contact& one : netlist.contacts) {
    const int from = node(one.from), to = node(one.to);
    elements_.push_back(
        assumptions.switching
            ? make_moving_contact(from, to, {node(one.control), static_cast<int>(count_++)}, model)
            : make_contact(from, to, model, one.position == assumptions.position));
  }
}

void Equations::add_levels(const Netlist& netlist) {
  for (const Comparator& one : netlist.comparators)
    elements_.push_back(
        make_comparator(node(one.in), node(one.out), hold(one.out), one.gain, one.threshold_v));
  const auto places = [&](const std::vector<std::string>& names) {
    std::vector<int> out;
    for (const std::string& name : names) out.push_back(node(name));
    return out;
  };
  for (const Gate& one : netlist.gates)
    elements_.push_back(make_gate(places(one.high), places(one.low), node(one.out), hold(one.out)));
}

int Equations::hold(const std::string& name) {
  held_.push_back({node(name), static_cast<int>(count_)});
  return static_cast<int>(count_++);
}

void Equations::number(const std::string& name) {
  if (name != "0" && name != input_) nodes_.try_emplace(name, static_cast<int>(nodes_.size()));
}

int Equations::node(const std::string& name) const {
  if (name == "0") return kGround;
  if (name == input_) return kInput;
  const auto at = nodes_.find(name);
  if (at == nodes_.end()) throw std::logic_error("a netlist without a node " + name);
  return at->second;
}

void Equations::evaluate(const Point& at, std::span<double> f, std::span<double> q,
                         std::vector<Stamps::Slope>& slopes) const {
  std::ranges::fill(f, 0.0);
  std::ranges::fill(q, 0.0);
  slopes.clear();
  Stamps stamps(f, q, slopes);
  for (const auto& element : elements_) element->stamp(at, stamps);
}

void Equations::linearise(const std::vector<double>& x, double input_v) {
  evaluate({x, input_v, {}}, {}, {}, slopes_);
  // A node that is read only, and that nothing drives, stays where it is.
  std::vector<bool> driven(nodes_.size(), false);
  for (const Stamps::Slope& one : slopes_) {
    if (static_cast<std::size_t>(one.row) < driven.size()) driven[static_cast<std::size_t>(one.row)] = true;
  }
  for (std::size_t i = 0; i < driven.size(); ++i) {
    if (!driven[i]) slopes_.push_back({static_cast<int>(i), static_cast<int>(i), 1.0, 0.0});
  }
}

void Equations::linearise(const std::map<std::string, double>& volts) {
  std::vector<double> x(count_, 0.0);
  double input_v = 0.0;
  for (const auto& [name, value] : volts) {
    if (name == input_) input_v = value;
    if (const auto at = nodes_.find(name); at != nodes_.end())
      x[static_cast<std::size_t>(at->second)] = value;
  }
  linearise(x, input_v);
}

SparseSystem Equations::small_signal(RadPerSecond w) const {
  SparseSystem out{{}, Eigen::VectorXcd::Zero(unknowns())};
  for (const Stamps::Slope& one : slopes_) {
    const Complex value(one.f, w.value * one.q);
    if (one.column == kInput) {
      out.b(one.row) -= value;
    } else {
      out.add(one.row, one.column, value);
    }
  }
  return out;
}

Complex Equations::response(RadPerSecond w, const std::string& name) const {
  const int at = node(name);
  return at < 0 ? Complex(at == kInput ? 1.0 : 0.0) : solve_sparse(small_signal(w))(at);
}

Eigen::VectorXcd Equations::ways_to(RadPerSecond w, const std::string& name) const {
  SparseSystem s = small_signal(w);
  s.transpose();
  s.b.setZero();
  s.b(node(name)) = 1.0;
  return solve_sparse(s);
}

}  // namespace bodesmith::schematic
