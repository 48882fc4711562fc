#pragma once

#include <Eigen/Core>
#include <map>
#include <stdexcept>
#include <string>

#include "numeric/linear_algebra/dense.hpp"
#include "schematic/analysis/equations.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// V of every node at rest from the equations of all elements at once, by Newton's method on f(x) = 0: op-amps are nullors,
/// diodes ideal, capacitors open, the contacts of one position closed. `inputs`: V of nodes driven from outside; `start`: V
/// from which to begin. What RestPoint compiles, slowly.
inline std::map<std::string, double> operating_point(const Netlist& netlist,
                                                     const std::map<std::string, double>& inputs,
                                                     int position, const Deviations& off,
                                                     const std::map<std::string, double>& start) {
  Netlist driven = netlist;
  Deviations copy = off;
  for (const auto& [node, volts] : inputs) {
    driven.sources.push_back({"V" + node, "", node, volts});
    copy.source.push_back(0.0);
  }
  const Equations equations(
      driven, {.ideal_opamps = true, .ideal_diodes = true, .position = position, .input = "", .off = &copy});
  const auto n = static_cast<std::size_t>(equations.unknowns());
  std::vector<double> x(n, 0.0), f(n), q(n);
  const auto name_each = [&](auto each) {
    const auto one = [&](const std::string& name) {
      if (name != "0") each(name, x[static_cast<std::size_t>(equations.node(name))]);
    };
    for (const Part& part : driven.parts) one(part.from), one(part.to);
    for (const OpAmp& opamp : driven.opamps) one(opamp.plus), one(opamp.minus), one(opamp.out);
    for (const Multiplier& m : driven.multipliers) one(m.x), one(m.y), one(m.z), one(m.out);
    for (const Contact& contact : driven.contacts) one(contact.from), one(contact.to);
    for (const Source& source : driven.sources) one(source.node);
  };
  name_each([&](const std::string& name, double& volts) {
    if (const auto at = start.find(name); at != start.end()) volts = at->second;
  });
  std::vector<Stamps::Slope> slopes;
  constexpr int kMostSteps = 100;
  constexpr double kSmallStep = 1e-15;
  double before = 1e300;
  for (int step = 0; step < kMostSteps; ++step) {
    equations.evaluate({x, 0.0, {}}, f, q, slopes);
    Eigen::MatrixXd g = Eigen::MatrixXd::Zero(equations.unknowns(), equations.unknowns());
    for (const Stamps::Slope& one : slopes) g(one.row, one.column) += one.f;
    // Nodes that only capacitors meet stay where they are.
    for (Eigen::Index i = 0; i < g.rows(); ++i) {
      if (g.row(i).isZero(0.0)) g(i, i) = 1.0;
    }
    const Eigen::VectorXd change = solve_lu(g, Eigen::Map<const Eigen::VectorXd>(f.data(), g.rows()));
    const double size = change.head(equations.nodes()).cwiseAbs().maxCoeff();
    if (!(size < 1e300)) break;
    for (std::size_t i = 0; i < n; ++i) x[i] -= change(static_cast<Eigen::Index>(i));
    // At the end a step is rounding only, and no smaller than the one before.
    if (size < kSmallStep || (size < 1e-9 && size >= before)) {
      std::map<std::string, double> out;
      name_each([&](const std::string& name, double& volts) { out[name] = volts; });
      return out;
    }
    before = size;
  }
  throw std::runtime_error("the circuit's voltages at rest were not found");
}

}  // namespace bodesmith::schematic
