#include "synthesis/parts/netlist_maker.hpp"

namespace bodesmith::circuit {

using schematic::Part;

int NetlistMaker::part(Part one) {
  to_.parts.push_back(std::move(one));
  return static_cast<int>(to_.parts.size()) - 1;
}

std::size_t NetlistMaker::add_group(std::string title, schematic::Purpose purpose) {
  to_.groups.push_back({std::move(title), purpose});
  return to_.groups.size() - 1;
}

int NetlistMaker::resistor(std::string name, std::string role, std::string from, std::string to,
                           double wanted, std::optional<double> realised) {
  return part({Part::Kind::resistor, std::move(name), std::move(role), group, std::move(from), std::move(to),
               resistors_.name(), wanted, realised ? *realised : resistors_.nearest(wanted)});
}

int NetlistMaker::capacitor(std::string name, std::string role, std::string from, std::string to,
                            double wanted) {
  return part({Part::Kind::capacitor, std::move(name), std::move(role), group, std::move(from), std::move(to),
               capacitors_.name(), wanted, capacitors_.nearest(wanted)});
}

int NetlistMaker::diode(std::string name, std::string role, std::string anode, std::string cathode) {
  return part({Part::Kind::diode, std::move(name), std::move(role), group, std::move(anode),
               std::move(cathode), "1N4148", 0.0, 0.0});
}

int NetlistMaker::opamp(std::string role, std::string plus, std::string minus, std::string out,
                        std::string name) {
  if (name.empty()) name = "U" + std::to_string(to_.opamps.size() + 1);
  to_.opamps.push_back(
      {std::move(name), std::move(role), group, std::move(plus), std::move(minus), std::move(out), false});
  return static_cast<int>(to_.opamps.size()) - 1;
}

NetlistMaker::Sum NetlistMaker::sum(const std::vector<Weight>& weights, const std::vector<double>& gains,
                                    const SummingDesign& design, const std::string& letters,
                                    const std::string& tail, const std::string& what, std::string role,
                                    const std::string& plus, const std::string& minus,
                                    const std::string& out) {
  const SummingResistors& realised = design.realised;
  Sum made;
  bool plus_used = false;
  double minus_siemens = 0.0;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    made.weights.push_back(-1);
    if (gains[k] == 0.0) continue;
    const bool at_plus = gains[k] > 0.0;
    made.weights.back() = resistor(weights[k].name, weights[k].role, weights[k].node, at_plus ? plus : minus,
                                   design.exact.weights[k], realised.weights[k]);
    plus_used = plus_used || at_plus;
    if (!at_plus) minus_siemens += 1.0 / realised.weights[k];
  }
  resistor(letters + "f" + tail, "feedback of the sum, " + what, minus, out, design.exact.feedback,
           realised.feedback);
  if (realised.balance > 0.0) {
    resistor(letters + "b" + tail, "balance of the sum, " + what, realised.balance_at_plus ? plus : minus,
             "0", design.exact.balance, realised.balance);
    if (!realised.balance_at_plus) minus_siemens += 1.0 / realised.balance;
  }
  made.opamp = opamp(std::move(role), plus_used ? plus : "0", minus, out);
  made.noise_gain = 1.0 + minus_siemens * realised.feedback;
  return made;
}

}  // namespace bodesmith::circuit
