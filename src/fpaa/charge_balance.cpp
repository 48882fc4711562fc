#include "fpaa/charge_balance.hpp"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "numeric/dense.hpp"
#include "numeric/matrix_exponential.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A voltage as a linear form of the outputs V, the inverting inputs v and the inputs x.
struct Volts {
  Index opamp = -1;
  Index virtual_ground = -1;
  Index input = -1;
  bool open = false;
};

Volts volts_of(const PlateNode& node) {
  Volts out;
  switch (node.kind) {
    case PlateNode::Kind::open:
      out.open = true;
      break;
    case PlateNode::Kind::ground:
      break;
    case PlateNode::Kind::input:
      out.input = node.number - 1;
      break;
    case PlateNode::Kind::opamp:
      out.opamp = node.number - 1;
      break;
    case PlateNode::Kind::virtual_ground:
      out.virtual_ground = node.number - 1;
      break;
  }
  return out;
}

const PlateNode& in_phase(const Plate& plate, int phase) {
  return phase == 1 ? plate.phase1 : plate.phase2;
}

/// The inverting inputs during one phase: sum_v * v = charge + by_output * V + by_input * x.
struct Junctions {
  VectorXd sum_v;
  MatrixXd charge;  ///< of each junction from the charges of the capacitors
  MatrixXd by_output;
  MatrixXd by_input;
};

Junctions junctions_of(const StageSwitches& stage, int phase, Index inputs) {
  const auto opamps = static_cast<Index>(stage.opamps.size());
  const auto capacitors = static_cast<Index>(stage.capacitors.size());
  Junctions out{VectorXd::Zero(opamps), MatrixXd::Zero(opamps, capacitors), MatrixXd::Zero(opamps, opamps),
                MatrixXd::Zero(opamps, inputs)};
  for (Index c = 0; c < capacitors; ++c) {
    const StageCapacitor& one = stage.capacitors[static_cast<std::size_t>(c)];
    const Volts near = volts_of(in_phase(one.near, phase));
    const Volts far = volts_of(in_phase(one.far, phase));
    if (near.open || far.open || far.virtual_ground < 0) continue;
    const Index k = far.virtual_ground;
    const double units = one.units;
    out.sum_v(k) += units;
    out.charge(k, c) -= 1.0;
    if (near.opamp >= 0) out.by_output(k, near.opamp) += units;
    if (near.input >= 0) out.by_input(k, near.input) += units;
  }
  return out;
}

}  // namespace

ChargeBalance::ChargeBalance(const StageSwitches& stage, const OpAmpModel& opamp, Hertz clock)
    : first_(map_of(stage, opamp, 1, 0.5 / clock.value)),
      second_(map_of(stage, opamp, 2, 0.5 / clock.value)),
      output_(static_cast<Index>(stage.capacitors.size()) + stage.output - 1),
      phase_(stage.output_phase == 2 ? 2 : 1),
      clock_(clock) {}

ChargeBalance::PhaseMap ChargeBalance::map_of(const StageSwitches& stage, const OpAmpModel& opamp, int phase,
                                              double length_s) const {
  const auto opamps = static_cast<Index>(stage.opamps.size());
  const auto capacitors = static_cast<Index>(stage.capacitors.size());
  const Index inputs = std::max(1, stage.inputs());
  const Junctions at = junctions_of(stage, phase, inputs);
  // v = from_charge q + from_output V + from_input x; q: charges at the phase's start.
  MatrixXd from_charge = at.charge;
  MatrixXd from_output = at.by_output;
  MatrixXd from_input = at.by_input;
  for (Index k = 0; k < opamps; ++k) {
    const bool reset = stage.opamps[static_cast<std::size_t>(k)].reset_phase == phase;
    const double scale = at.sum_v(k) > 0.0 && !reset ? 1.0 / at.sum_v(k) : 0.0;
    from_charge.row(k) *= scale;
    from_output.row(k) *= scale;
    from_input.row(k) *= scale;
    if (reset) from_output(k, k) = 1.0;  // the feedback switch: v is the output itself
  }
  // dV/dt = rate (-v - V/gain), driven by constants: exp of [[A, 1], [0, 0]] t gives both exp(At) and its
  // integral.
  const double rate = 2.0 * std::numbers::pi * opamp.gain_bandwidth.value * length_s;
  MatrixXd block = MatrixXd::Zero(2 * opamps, 2 * opamps);
  block.topLeftCorner(opamps, opamps) =
      -rate * (from_output + MatrixXd::Identity(opamps, opamps) / opamp.gain);
  block.topRightCorner(opamps, opamps) = MatrixXd::Identity(opamps, opamps);
  const MatrixXd grown = matrix_exponential(block);
  const MatrixXd decay = grown.topLeftCorner(opamps, opamps);
  const MatrixXd drive = -rate * grown.topRightCorner(opamps, opamps);

  const Index size = capacitors + opamps;
  PhaseMap out{MatrixXd::Identity(size, size), MatrixXd::Zero(size, inputs)};
  out.state.bottomLeftCorner(opamps, capacitors) = drive * from_charge;
  out.state.bottomRightCorner(opamps, opamps) = decay;
  out.input.bottomRows(opamps) = drive * from_input;
  // v at the end, then every capacitor's charge.
  MatrixXd v_state = from_output * out.state.bottomRows(opamps);
  v_state.leftCols(capacitors) += from_charge;
  const MatrixXd v_input = from_output * out.input.bottomRows(opamps) + from_input;
  for (Index c = 0; c < capacitors; ++c) {
    const StageCapacitor& one = stage.capacitors[static_cast<std::size_t>(c)];
    const Volts near = volts_of(in_phase(one.near, phase));
    const Volts far = volts_of(in_phase(one.far, phase));
    if (near.open || far.open) continue;
    Eigen::RowVectorXd by_state = Eigen::RowVectorXd::Zero(size);
    Eigen::RowVectorXd by_input = Eigen::RowVectorXd::Zero(inputs);
    for (const auto& [volts, sign] : {std::pair{near, 1.0}, std::pair{far, -1.0}}) {
      if (volts.opamp >= 0) {
        by_state += sign * out.state.row(capacitors + volts.opamp);
        by_input += sign * out.input.row(capacitors + volts.opamp);
      }
      if (volts.virtual_ground >= 0) {
        by_state += sign * v_state.row(volts.virtual_ground);
        by_input += sign * v_input.row(volts.virtual_ground);
      }
      if (volts.input >= 0) by_input(volts.input) += sign;
    }
    out.state.row(c) = one.units * by_state;
    out.input.row(c) = one.units * by_input;
  }
  return out;
}

Complex ChargeBalance::response(RadPerSecond w, int input) const {
  return response_in_phase(w, phase_, input);
}

Complex ChargeBalance::response_in_phase(RadPerSecond w, int phase, int input) const {
  // s(n) = M s(n-1) + N x(n), over both phases.
  const MatrixXd period = second_.state * first_.state;
  const MatrixXd by_input = second_.state * first_.input + second_.input;
  const Complex back = std::polar(1.0, -w.value / clock_.value);  // 1/z
  const Index size = period.rows();
  const Eigen::MatrixXcd loop = Eigen::MatrixXcd::Identity(size, size) - back * period.cast<Complex>();
  const Eigen::VectorXcd end = solve_lu(loop, by_input.col(input - 1).cast<Complex>());
  if (phase == 2) return end(output_);
  return (first_.state.row(output_).cast<Complex>() * end)(0) * back + first_.input(output_, input - 1);
}

}  // namespace bodesmith::fpaa
