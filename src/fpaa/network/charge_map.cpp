#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "fpaa/network/switched_network.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "schematic/analysis/sets.hpp"

namespace bodesmith::fpaa {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// What decides the voltage of a group.
struct GroupHold {
  bool ground = false;
  int input = -1;  ///< index of an input
  int opamp = -1;  ///< index of the op-amp whose output it is
  bool is_free() const { return !ground && input < 0 && opamp < 0; }
};

/// A capacitance, or a conductance, between two nodes.
void stamp(MatrixXd& nodal, int a, int b, double size) {
  nodal(a, a) += size;
  nodal(b, b) += size;
  nodal(a, b) -= size;
  nodal(b, a) -= size;
}

/// Nodal capacitances of all nodes: charges from voltages.
MatrixXd capacitance_matrix(const SwitchedNetwork& network) {
  MatrixXd out = MatrixXd::Zero(network.nodes, network.nodes);
  for (const SwitchedNetwork::Capacitor& c : network.capacitors) stamp(out, c.a, c.b, c.size);
  return out;
}

/// Of every closed switch a conductance of 1.
MatrixXd conductance_matrix(const SwitchedNetwork& network, const std::vector<bool>& closed) {
  MatrixXd out = MatrixXd::Zero(network.nodes, network.nodes);
  for (std::size_t i = 0; i < closed.size(); ++i) {
    if (closed[i]) stamp(out, network.switches[i].a, network.switches[i].b, 1.0);
  }
  return out;
}

/// P of A P + P A' + Q = 0, A stable but for ways to move that Q does not excite (charges that are conserved).
MatrixXd stationary_covariance(const MatrixXd& a, const MatrixXd& q) {
  constexpr double kDamping = 1e-8;  ///< of what is conserved; rounding divided by it stays small
  const Index n = a.rows();
  if (n == 0) return q;
  const MatrixXd damped = a - kDamping * a.cwiseAbs().maxCoeff() * MatrixXd::Identity(n, n);
  MatrixXd sum = MatrixXd::Zero(n * n, n * n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      for (Index k = 0; k < n; ++k) {
        sum(i * n + j, k * n + j) += damped(i, k);
        sum(i * n + j, i * n + k) += damped(j, k);
      }
    }
  }
  const Eigen::VectorXd p = solve_lu(sum, Eigen::VectorXd(-q.reshaped()));
  return p.reshaped(n, n);
}

class MapMaker {
 public:
  MapMaker(const SwitchedNetwork& network, const std::vector<bool>& closed)
      : network_(network),
        closed_(closed),
        joined_(static_cast<std::size_t>(network.nodes)),
        capacitance_(capacitance_matrix(network)) {
    for (std::size_t i = 0; i < network.switches.size(); ++i) {
      if (closed[i]) joined_.join(network.switches[i].a, network.switches[i].b);
    }
    holds_.resize(static_cast<std::size_t>(network.nodes));
  }

  ChargeMap make(bool with_noise) {
    find_holds();
    number_groups();
    solve(with_noise);
    if (with_noise) add_switch_noise();
    return std::move(out_);
  }

 private:
  GroupHold& hold_of(int node) { return holds_[static_cast<std::size_t>(joined_.of(node))]; }

  void find_holds() {
    hold_of(0).ground = true;
    for (std::size_t i = 0; i < network_.inputs.size(); ++i) {
      GroupHold& hold = hold_of(network_.inputs[i]);
      if (!hold.is_free()) throw DesignError("a switch joins an input to ground or to another input");
      hold.input = static_cast<int>(i);
    }
    for (std::size_t k = 0; k < network_.opamps.size(); ++k) {
      GroupHold& hold = hold_of(network_.opamps[k].out);
      if (!hold.is_free()) {
        throw DesignError(
            fmt::format("the output of op-amp {} is joined to ground, an input or another output", k + 1));
      }
      hold.opamp = static_cast<int>(k);
    }
  }

  /// Charges of free groups; a free group without a capacitor has none, and no voltage that matters.
  void number_groups() {
    std::vector<bool> has_capacitor(holds_.size(), false);
    for (const SwitchedNetwork::Capacitor& c : network_.capacitors) {
      if (!(c.size > 0.0)) continue;
      has_capacitor[static_cast<std::size_t>(joined_.of(c.a))] = true;
      has_capacitor[static_cast<std::size_t>(joined_.of(c.b))] = true;
    }
    std::vector<int> charge_of_group(holds_.size(), -1);
    for (int node = 0; node < network_.nodes; ++node) {
      const auto g = static_cast<std::size_t>(joined_.of(node));
      if (holds_[g].is_free() && has_capacitor[g] && charge_of_group[g] < 0)
        charge_of_group[g] = static_cast<int>(out_.charges++);
    }
    out_.charge_of.resize(holds_.size());
    for (int node = 0; node < network_.nodes; ++node) {
      out_.charge_of[static_cast<std::size_t>(node)] =
          charge_of_group[static_cast<std::size_t>(joined_.of(node))];
    }
  }

  /// Unknowns: voltages of the charge groups, then of the op-amps' outputs. Equations: the charges, then
  /// v(minus) = v(plus) of every op-amp.
  void solve(bool with_noise) {
    const auto opamps = static_cast<Index>(network_.opamps.size());
    const auto inputs = static_cast<Index>(network_.inputs.size());
    const Index size = out_.charges + opamps;
    // Each node's voltage from the unknowns and from the inputs.
    MatrixXd by_unknown = MatrixXd::Zero(network_.nodes, size);
    MatrixXd by_input = MatrixXd::Zero(network_.nodes, inputs);
    for (int node = 0; node < network_.nodes; ++node) {
      const GroupHold& hold = hold_of(node);
      const int charge = out_.charge_of[static_cast<std::size_t>(node)];
      if (charge >= 0) by_unknown(node, charge) = 1.0;
      if (hold.opamp >= 0) by_unknown(node, out_.charges + hold.opamp) = 1.0;
      if (hold.input >= 0) by_input(node, hold.input) = 1.0;
    }
    const MatrixXd sums = regrouped(out_);
    MatrixXd a = MatrixXd::Zero(size, size);
    MatrixXd right_q = MatrixXd::Zero(size, out_.charges);
    MatrixXd right_u = MatrixXd::Zero(size, inputs);
    const MatrixXd charges = times(sums, capacitance_);
    a.topRows(out_.charges) = times(charges, by_unknown);
    right_q.topRows(out_.charges).setIdentity();
    right_u.topRows(out_.charges) = -times(charges, by_input);
    for (Index k = 0; k < opamps; ++k) {
      const SwitchedNetwork::OpAmp& amp = network_.opamps[static_cast<std::size_t>(k)];
      a.row(out_.charges + k) = by_unknown.row(amp.minus) - by_unknown.row(amp.plus);
      right_u.row(out_.charges + k) = by_input.row(amp.plus) - by_input.row(amp.minus);
    }
    const Eigen::FullPivLU<MatrixXd> lu(a);
    if (!lu.isInvertible()) {
      throw DesignError(
          "the switches leave a voltage open (an op-amp without feedback), expected every op-amp's "
          "output to act on its inverting input in every phase");
    }
    const MatrixXd from_q = lu.solve(right_q);
    const MatrixXd from_u = lu.solve(right_u);
    out_.volts_q = from_q.bottomRows(opamps);
    out_.volts_u = from_u.bottomRows(opamps);
    const MatrixXd by_capacitors = times(capacitance_, by_unknown);
    out_.nodes_q = times(by_capacitors, from_q);
    out_.nodes_u = times(by_capacitors, from_u) + times(capacitance_, by_input);
    if (with_noise) add_opamp_noise(a, by_unknown);
    add_lateness();
  }

  /// How far nodes and outputs stay behind, x, to the first order, d/dt of what is stored given: behind a switch the drop of the
  /// current that its node's plates take, at the inputs of an op-amp what its output's motion needs,
  ///   sum over closed switches (x_i - x_j) = R C_u dQ_i/dt,   x(minus) - x(plus) = dV_out/dt / (2 pi f),
  /// and the charge of each group, which is conserved.
  void add_lateness() {
    const bool slow =
        std::ranges::any_of(network_.opamps, [](const auto& amp) { return amp.late_s() > 0.0; });
    if (!slow && network_.switch_s == 0.0) return;
    const auto nodes = static_cast<Index>(network_.nodes),
               opamps = static_cast<Index>(network_.opamps.size());
    MatrixXd a = conductance_matrix(network_, closed_), given = MatrixXd::Zero(nodes, nodes + opamps);
    given.leftCols(nodes) = network_.switch_s * MatrixXd::Identity(nodes, nodes);
    const auto replace = [&](Index row) {
      a.row(row).setZero();
      given.row(row).setZero();
    };
    std::vector<bool> summed(static_cast<std::size_t>(out_.charges), false);
    for (Index node = 0; node < nodes; ++node) {
      const int charge = out_.charge_of[static_cast<std::size_t>(node)];
      if (charge >= 0 && !summed[static_cast<std::size_t>(charge)]) {
        summed[static_cast<std::size_t>(charge)] = true;
        replace(node);
        for (Index other = 0; other < nodes; ++other) {
          if (out_.charge_of[static_cast<std::size_t>(other)] == charge)
            a.row(node) += capacitance_.row(other);
        }
      } else if (a(node, node) == 0.0 || (charge < 0 && hold_of(static_cast<int>(node)).is_free())) {
        replace(node);  // a voltage that does not matter
        a(node, node) = 1.0;
      }
    }
    const auto hold = [&](Index node) {
      replace(node);
      a(node, node) = 1.0;
    };
    hold(0);
    for (const int node : network_.inputs) hold(node);
    for (Index k = 0; k < opamps; ++k) {
      const SwitchedNetwork::OpAmp& amp = network_.opamps[static_cast<std::size_t>(k)];
      replace(amp.out);
      a(amp.out, amp.minus) += 1.0;
      a(amp.out, amp.plus) -= 1.0;
      given(amp.out, nodes + k) = amp.late_s();
    }
    const MatrixXd x = solve_lu_columns(a, given);
    out_.late.resize(opamps + nodes, nodes + opamps);
    for (Index k = 0; k < opamps; ++k)
      out_.late.row(k) = x.row(network_.opamps[static_cast<std::size_t>(k)].out);
    out_.late.bottomRows(nodes) = times(capacitance_, x);
  }

  /// `a`: the equations of all unknowns. Of op-amps with a bandwidth the outputs are given instead of their inputs equal.
  void add_opamp_noise(MatrixXd a, const MatrixXd& by_unknown) {
    ChargeMap::OpAmpNoise& out = out_.opamps;
    for (std::size_t k = 0; k < network_.opamps.size(); ++k) {
      if (network_.opamps[k].noise_per_hz > 0.0) out.of.push_back(static_cast<Index>(k));
    }
    const auto slow = static_cast<Index>(out.of.size());
    MatrixXd given = MatrixXd::Zero(a.rows(), slow);
    for (Index i = 0; i < slow; ++i) {
      const Index row = out_.charges + out.of[static_cast<std::size_t>(i)];
      a.row(row).setZero();
      a(row, row) = given(row, i) = 1.0;
    }
    const MatrixXd unknown = slow > 0 ? solve_lu_columns(a, given) : given;
    MatrixXd back(slow, slow);  // what comes back to each inverting input
    Eigen::VectorXd rate(slow), intensity(slow);
    for (Index i = 0; i < slow; ++i) {
      const SwitchedNetwork::OpAmp& amp =
          network_.opamps[static_cast<std::size_t>(out.of[static_cast<std::size_t>(i)])];
      const Eigen::VectorXd across = by_unknown.row(amp.minus) - by_unknown.row(amp.plus);
      back.row(i) = transpose_times(unknown, across);
      rate(i) = amp.gain_bandwidth.rad_s().value;
      intensity(i) = 0.5 * amp.noise_per_hz * rate(i) * rate(i);
    }
    const MatrixXd towards_rest = rate.asDiagonal() * back;
    if (slow > 0) out.slowest_s = 1.0 / eigenvalues(towards_rest).real().minCoeff();
    if (!(out.slowest_s >= 0.0) || std::isinf(out.slowest_s))
      throw DesignError("the op-amps do not settle in a phase, expected bandwidths with which they do");
    out.volts = unknown.bottomRows(static_cast<Index>(network_.opamps.size()));
    out.nodes = times(times(capacitance_, by_unknown), unknown);
    out.settling_s = solve_lu_columns(towards_rest, MatrixXd::Identity(slow, slow));
    out.covariance = stationary_covariance(-towards_rest, intensity.asDiagonal());
  }

  /// Every closed switch a conductance of 1 (equal ones: only their ratios count) with white current of intensity
  /// 2 kT. Kirchhoff's law at every node that is not held and at every inverting input, unknown: the voltages of
  /// the former and of the op-amps' outputs,
  ///   E dx/dt + G x = B w,
  /// E singular: with E = U diag(s, 0) V' the part without capacitance is algebraic, and the rest
  ///   dy/dt = A y + F w,   A P + P A' + 2 F F' = 0
  /// has the covariance P kT when the switches open. (What an op-amp's feedback gives back to the switched
  /// capacitors is in it: a low pass has less than kT C a branch.)
  void add_switch_noise() {
    const MatrixXd conductance = conductance_matrix(network_, closed_);
    MatrixXd currents = MatrixXd::Zero(network_.nodes, static_cast<Index>(network_.switches.size()));
    for (std::size_t i = 0; i < network_.switches.size(); ++i) {
      if (!closed_[i]) continue;
      const SwitchedNetwork::Switch& s = network_.switches[i];
      currents(s.a, static_cast<Index>(i)) += 1.0;
      currents(s.b, static_cast<Index>(i)) -= 1.0;
    }
    const NoiseUnknowns unknown = noise_unknowns(conductance);
    const MatrixXd e = capacitance_(unknown.laws, unknown.voltages);
    const MatrixXd g = conductance(unknown.laws, unknown.voltages);
    const MatrixXd b = currents(unknown.laws, Eigen::all);
    const SquareSvd svd = square_svd(e);
    Index rank = 0;
    while (rank < e.rows() && svd.values(rank) > 1e-12 * svd.values(0)) ++rank;
    const Index rest = e.rows() - rank;
    const MatrixXd gt = times(times(svd.u.transpose(), g), svd.v);
    const MatrixXd bt = times(svd.u.transpose(), b);
    // z = back y where there is no capacitance (and white noise, which no capacitor keeps).
    MatrixXd back = MatrixXd::Zero(rest, rank);
    MatrixXd direct = MatrixXd::Zero(rest, b.cols());
    if (rest > 0) {
      const MatrixXd algebraic = gt.bottomRightCorner(rest, rest);
      back = -least_norm_columns(algebraic, gt.bottomLeftCorner(rest, rank));
      direct = least_norm_columns(algebraic, bt.bottomRows(rest));
    }
    const Eigen::VectorXd inverted = svd.values.head(rank).cwiseInverse();
    const MatrixXd across = gt.topRightCorner(rank, rest);
    const MatrixXd a = -(inverted.asDiagonal() * (gt.topLeftCorner(rank, rank) + times(across, back)));
    const MatrixXd f = inverted.asDiagonal() * (bt.topRows(rank) - times(across, direct));
    const MatrixXd y = svd.v.leftCols(rank) + times(svd.v.rightCols(rest), back);
    const MatrixXd charges = times(capacitance_(Eigen::all, unknown.voltages), y);
    const MatrixXd covariance = stationary_covariance(a, 2.0 * gram(f.transpose()));
    const MatrixXd to_charges = charges.transpose();
    out_.noise = times(times(charges, covariance), to_charges);
  }

  struct NoiseUnknowns {
    std::vector<int> laws;      ///< nodes at which currents add up to nothing
    std::vector<int> voltages;  ///< nodes whose voltage is not known
  };
  NoiseUnknowns noise_unknowns(const MatrixXd& conductance) const {
    enum class Role { loose, held, inverting, output };
    std::vector<Role> role(static_cast<std::size_t>(network_.nodes), Role::loose);
    const auto set = [&](int node, Role is) { role[static_cast<std::size_t>(node)] = is; };
    set(0, Role::held);
    for (const int node : network_.inputs) set(node, Role::held);
    for (const SwitchedNetwork::OpAmp& amp : network_.opamps) {
      set(amp.out, Role::output);
      // A follower's inverting input is its output, and needs no current law.
      if (amp.minus != amp.out) set(amp.minus, Role::inverting);
    }
    NoiseUnknowns out;
    for (int node = 0; node < network_.nodes; ++node) {
      const Role is = role[static_cast<std::size_t>(node)];
      const bool joined = capacitance_(node, node) > 0.0 || conductance(node, node) > 0.0;
      if (is == Role::inverting || (is == Role::loose && joined)) out.laws.push_back(node);
      if (is == Role::loose && joined) out.voltages.push_back(node);
    }
    for (const SwitchedNetwork::OpAmp& amp : network_.opamps) {
      if (amp.minus != amp.out) out.voltages.push_back(amp.out);
    }
    return out;
  }

  const SwitchedNetwork& network_;
  const std::vector<bool>& closed_;
  schematic::Sets joined_;  ///< nodes that closed switches join
  MatrixXd capacitance_;
  std::vector<GroupHold> holds_;
  ChargeMap out_;
};

}  // namespace

MatrixXd regrouped(const ChargeMap& next) {
  const auto nodes = static_cast<Index>(next.charge_of.size());
  MatrixXd out = MatrixXd::Zero(next.charges, nodes);
  for (Index node = 0; node < nodes; ++node) {
    const int charge = next.charge_of[static_cast<std::size_t>(node)];
    if (charge >= 0) out(charge, node) = 1.0;
  }
  return out;
}

ChargeMap charge_map(const SwitchedNetwork& network, const std::vector<bool>& closed, bool with_noise) {
  return MapMaker(network, closed).make(with_noise);
}

}  // namespace bodesmith::fpaa
