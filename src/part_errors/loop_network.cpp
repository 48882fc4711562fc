#include "part_errors/loop_network.hpp"

#include <cmath>
#include <numbers>

#include "numeric/dense.hpp"

namespace bodesmith::part_errors {
namespace {

using controller::AnalogController;
using controller::Part;
using Complex = LoopNetwork::Complex;

constexpr int kStill = -1;  ///< ground for small signals
constexpr int kInput = -2;  ///< the cut loop's 1 V
constexpr double kLeastOhm = 1e-3;

}  // namespace

LoopNetwork::LoopNetwork(const AnalogController& controller, const LoopPoint& point)
    : controller_(controller), point_(point) {
  choose_sections();
  const Wiring wiring(controller);
  RestPoint rest(wiring, controller::Deviations::none(controller));
  if (controller.slope) slope_v_ = -point.operating.value * controller.slope->volts_per_hz;
  rest.set_slope(slope_v_);
  const bool rising = point.branch == Disturbance::Branch::ascending;
  reference_v_ = point.v;
  if (wiring.self_fed()) reference_v_ = (point.v - rest.made(0.0, point.v, rising)) / rest.reference_gain();
  rest.made(reference_v_, point.v, rising);
  const auto volts = [&](const std::string& name) {
    return name == "v" && wiring.self_fed() ? point.v : rest.volts(name);
  };
  for (const controller::Multiplier& m : controller.multipliers) {
    if (!in_loop(m.section)) continue;
    const double u = controller.multiplier.scale_v;
    gains_.push_back({m.out, m.x, m.y, m.z, volts(m.y) / u, volts(m.x) / u});
  }
  for (std::size_t i = 0; i < controller.opamps.size(); ++i) {
    if (in_loop(controller.opamps[i].section)) opamps_.push_back(i);
  }
  number_nodes();
}

void LoopNetwork::choose_sections() {
  const AnalogController& c = controller_;
  const auto multiplier = [&](int i) {
    if (i >= 0) generator_sections_.insert(c.multipliers[static_cast<std::size_t>(i)].section);
  };
  for (const controller::Pass& pass : c.passes) {
    multiplier(pass.square);
    multiplier(pass.cube);
    for (const int part : pass.divider) {
      if (part >= 0) generator_sections_.insert(c.part(part).section);
    }
    for (const controller::BranchPath& path : pass.branch) {
      multiplier(path.gain);
      if (path.sum >= 0) generator_sections_.insert(c.op(c.sum(path.sum).opamp).section);
      if (path.contact >= 0) sections_.insert(c.contacts[static_cast<std::size_t>(path.contact)].section);
    }
    sections_.insert(c.op(c.sum(pass.output).opamp).section);
  }
  sections_.insert(generator_sections_.begin(), generator_sections_.end());
}

/// Only what the chosen sections drive or what resistors alone reach moves.
void LoopNetwork::number_nodes() {
  const AnalogController& c = controller_;
  std::set<std::string> still = {"0", "r"};
  for (const controller::VoltageReference& one : c.references) still.insert(one.node);
  for (const controller::OpAmp& u : c.opamps) {
    if (!in_loop(u.section)) still.insert(u.out);
  }
  for (const controller::Multiplier& m : c.multipliers) {
    if (!in_loop(m.section)) still.insert(m.out);
  }
  for (const controller::Rectifier& one : c.rectifiers) still.insert(one.node);
  const auto add = [&](const std::string& name) {
    if (still.count(name) == 0) nodes_.try_emplace(name, static_cast<int>(nodes_.size()));
  };
  for (const Part& part : c.parts) {
    if (!in_loop(part.section) || part.kind == Part::Kind::diode) continue;
    add(part.from);
    add(part.to);
  }
  for (const std::size_t i : opamps_) {
    add(c.opamps[i].plus);
    add(c.opamps[i].minus);
    add(c.opamps[i].out);
  }
  for (const Gain& g : gains_) {
    for (const std::string& name : {g.out, g.x, g.y, g.z}) add(name);
  }
  for (const controller::Contact& contact : c.contacts) {
    add(contact.from);
    add(contact.to);
  }
}

int LoopNetwork::node(const std::string& name, bool cut) const {
  if (cut && name == "v") return kInput;
  const auto at = nodes_.find(name);
  return at == nodes_.end() ? kStill : at->second;
}

/// Node equations; op-amps are Norton sources A (v+ - v-)/Ro behind Ro, multipliers ideal sources. `by_input`:
/// right-hand side for 1 V at the cut.
Eigen::MatrixXcd LoopNetwork::matrix(RadPerSecond w, bool cut, std::vector<Complex>& by_input) const {
  const AnalogController& c = controller_;
  const auto n = static_cast<Eigen::Index>(nodes_.size());
  Eigen::MatrixXcd a = Eigen::MatrixXcd::Zero(n, n);
  by_input.assign(nodes_.size(), 0.0);
  const Complex s(0.0, w.value);
  const auto add = [&](int row, int column, Complex value) {
    if (row < 0 || column == kStill) return;
    if (column == kInput) {
      by_input[static_cast<std::size_t>(row)] -= value;
    } else {
      a(row, column) += value;
    }
  };
  const auto between = [&](int p, int q, Complex y) {
    add(p, p, y);
    add(p, q, -y);
    add(q, q, y);
    add(q, p, -y);
  };
  for (const Part& part : c.parts) {
    if (!in_loop(part.section) || part.kind == Part::Kind::diode) continue;
    const bool here = cut && reads_argument(part.section);
    const Complex y = part.kind == Part::Kind::resistor ? Complex(1.0 / part.realised) : s * part.realised;
    between(node(part.from, here), node(part.to, here), y);
  }
  for (const controller::Contact& contact : c.contacts) {
    const bool closed = contact.rising == (point_.branch == Disturbance::Branch::ascending);
    const int from = node(contact.from, false), to = node(contact.to, false);
    between(from, to, closed ? 1.0 / c.analog_switch.on_ohm : c.analog_switch.off_siemens);
    add(from, from, s * c.analog_switch.source_f);
    add(to, to, s * (c.analog_switch.drain_f + c.analog_switch.charge_c / 10.0));
  }
  for (const std::size_t i : opamps_) {
    const controller::OpAmp& u = c.opamps[i];
    const circuit::OpAmpModel& type = c.type_of(u);
    const double ohm = std::max(type.output_resistance_ohm, kLeastOhm);
    const Complex gain = type.open_loop(w) / ohm;
    const bool here = cut && reads_argument(u.section);
    const int out = node(u.out, false);
    add(out, out, 1.0 / ohm);
    add(out, node(u.plus, here), -gain);
    add(out, node(u.minus, here), gain);
  }
  const Complex pole = 1.0 + s / c.multiplier.bandwidth.rad_s().value;
  for (const Gain& g : gains_) {
    const int out = node(g.out, false);
    if (out < 0) continue;
    a.row(out).setZero();
    by_input[static_cast<std::size_t>(out)] = 0.0;
    add(out, out, pole);
    add(out, node(g.x, cut), -g.by_x);
    add(out, node(g.y, cut), -g.by_y);
    add(out, node(g.z, cut), -1.0);
  }
  return a;
}

Complex LoopNetwork::generator(RadPerSecond w) const {
  if (controller_.form != controller::Form::self_fed) return 0.0;
  std::vector<Complex> by_input;
  const Eigen::MatrixXcd a = matrix(w, true, by_input);
  const Eigen::Map<const Eigen::VectorXcd> b(by_input.data(), static_cast<Eigen::Index>(by_input.size()));
  return -solve_lu(a, b)(node("v", false));
}

std::vector<Complex> LoopNetwork::return_ratios(RadPerSecond w) const {
  std::vector<Complex> unused, out;
  const Eigen::MatrixXcd a = matrix(w, false, unused);
  for (const std::size_t i : opamps_) {
    const controller::OpAmp& u = controller_.opamps[i];
    const circuit::OpAmpModel& type = controller_.type_of(u);
    const double ohm = std::max(type.output_resistance_ohm, kLeastOhm);
    const int at = node(u.out, false), plus = node(u.plus, false), minus = node(u.minus, false);
    // Its own source is replaced by 1 V: its row loses A, and 1/Ro flows in.
    Eigen::MatrixXcd own = a;
    const Complex gain = type.open_loop(w) / ohm;
    if (plus >= 0) own(at, plus) += gain;
    if (minus >= 0) own(at, minus) -= gain;
    Eigen::VectorXcd b = Eigen::VectorXcd::Zero(a.rows());
    b(at) = 1.0 / ohm;
    const Eigen::VectorXcd v = solve_lu(own, b);
    const Complex difference = (plus >= 0 ? v(plus) : Complex(0.0)) - (minus >= 0 ? v(minus) : Complex(0.0));
    out.push_back(-type.open_loop(w) * difference);
  }
  return out;
}

}  // namespace bodesmith::part_errors
