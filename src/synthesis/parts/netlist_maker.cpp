#include "synthesis/parts/netlist_maker.hpp"

#include <cmath>

namespace bodesmith::synthesis {

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

int NetlistMaker::opamp(std::string role, std::string plus, std::string minus, std::string out) {
  to_.opamps.push_back({"U" + std::to_string(to_.opamps.size() + 1), std::move(role), group, std::move(plus),
                        std::move(minus), std::move(out)});
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
    if (realised.weights[k] == 0.0) continue;
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

NetlistMaker::Rectifier NetlistMaker::rectifier(const std::string& node, const std::string& role,
                                                const std::string& from, const std::string& reference,
                                                double ratio) {
  constexpr double kOhm = 10e3;
  // Input and feedback are equal.
  double input = resistors_.nearest(kOhm), best = 1.0;
  if (!resistors_.is_exact()) {
    for (const double r : resistors_.values(kOhm, 2.2 * kOhm)) {
      const double off = std::abs(resistors_.nearest(r * ratio) / (r * ratio) - 1.0);
      if (off < best) {
        best = off;
        input = r;
      }
    }
  }
  const std::string minus = "m" + node, end = "e" + node;
  resistor("R" + node + "i", role + ", input", from, minus, input, input);
  const int other = resistor("R" + node + "r", role + ", threshold", reference, minus, input * ratio);
  resistor("R" + node + "f", role + ", feedback", minus, node, input, input);
  diode("D" + node + "a", role, node, end);
  diode("D" + node + "b", role, end, minus);
  return {opamp(role, "0", minus, end), to_.part(other).realised / input};
}

std::vector<double> NetlistMaker::inverting_sum(const std::vector<std::string>& from,
                                                const std::vector<double>& gains,
                                                const std::vector<std::vector<double>>& rows,
                                                const std::string& role, const std::string& out) {
  const SummingDesign design = search_sum(gains, rows, resistors_, role);
  std::vector<Weight> weights;
  for (std::size_t i = 0; i < from.size(); ++i)
    weights.push_back({from[i], "R" + out + std::to_string(i + 1), role + " from " + from[i]});
  sum(weights, gains, design, "R" + out, "", role, role, "0", "m" + out, out);
  return design.gains;
}

int NetlistMaker::signed_sum(const std::vector<std::string>& from, const std::vector<double>& gains,
                             const std::vector<std::vector<double>>& rows, const std::string& role,
                             const std::string& out, const std::string& inverted) {
  std::vector<std::string> nodes[2];  // inverted once, inverted twice
  std::vector<double> factors[2];
  std::vector<std::vector<double>> volts[2];
  for (const int side : {0, 1}) volts[side].resize(rows.size());
  std::vector<double> twice(rows.size(), 0.0);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const std::size_t side = gains[i] > 0.0 ? 1 : 0;
    nodes[side].push_back(from[i]);
    factors[side].push_back(-std::abs(gains[i]));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      volts[side][row].push_back(rows[row][i]);
      if (side == 1) twice[row] -= gains[i] * rows[row][i];
    }
  }
  if (!nodes[1].empty()) {
    // Steep pieces beside each other are large terms that nearly cancel: their sum stays within what the op-amp gives.
    constexpr double kRoom = 0.8;
    double most = 0.0;
    for (const double one : twice) most = std::max(most, std::abs(one));
    const double scale = std::min(1.0, kRoom * to_.opamp.swing_v / most);
    for (double& factor : factors[1]) factor *= scale;
    for (std::size_t row = 0; row < rows.size(); ++row) volts[1][row].push_back(scale * twice[row]);
    const std::vector<double> realised =
        inverting_sum(nodes[1], factors[1], volts[1], role + ", inverted", inverted);
    nodes[0].push_back(inverted);
    factors[0].push_back(-1.0 / scale);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      double got = 0.0;
      for (std::size_t k = 0; k < realised.size(); ++k) got += realised[k] * volts[1][row][k];
      volts[0][row].push_back(got);
    }
  }
  for (std::size_t row = 0; row < rows.size(); ++row) volts[0][row].push_back(rows[row].back());
  inverting_sum(nodes[0], factors[0], volts[0], role, out);
  return static_cast<int>(to_.opamps.size()) - 1;
}

}  // namespace bodesmith::synthesis
