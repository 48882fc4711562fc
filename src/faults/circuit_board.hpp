#pragma once

#include <map>

#include "faults/board.hpp"
#include "schematic/analysis/equations.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::faults {

/// A netlist of resistors, capacitors and op-amps between nodes "in" and "out" by nodal analysis. The inverse of its equations is kept at every measured frequency, so that
/// a fault (a change of rank one or two) costs a few products instead of a solution:
///   (A + U D V')^-1 = A^-1 - A^-1 U D (1 + V'A^-1 U D)^-1 V'A^-1   (Sherman, Morrison, Woodbury).
class CircuitBoard : public Board {
 public:
  /// Throws InputError for a channel at a node that is not there.
  /// `like`: takes the unknowns that this board has, so that both count them alike.
  CircuitBoard(const schematic::Netlist& circuit, Measurement measured, const Spread& spread,
               const CircuitBoard* like = nullptr);

  std::size_t unknowns() const override { return unknowns_.size(); }
  bool is_part(std::size_t unknown) const override { return unknowns_[unknown].part; }
  Prediction predict(const Effect& effect) const override;
  Eigen::VectorXcd response(const Effect& effect) const override;
  std::unique_ptr<ChangedBoard> changed_by(const Effect& effect) const override;
  std::unique_ptr<Board> with_parts(const Eigen::VectorXd& deviations) const override;
  std::vector<std::string> probe_nodes() const override;
  Eigen::VectorXcd at_node(const std::string& node, const Effect& effect) const override;
  std::vector<SolderedPart> soldered_parts() const override;
  Effect in_parallel(std::size_t part, double factor) const override;

  // For the kinds of fault.
  const schematic::Netlist& circuit() const { return circuit_; }
  const schematic::OpAmpModel& opamp() const { return model_; }
  /// Every node but ground and input.
  std::vector<std::string> nodes() const;
  double tolerance(std::size_t part) const;  ///< relative
  /// Part `part` with `factor` times its value (infinity: an open resistor, a shorted capacitor is 1e9).
  Effect changed(std::size_t part, double factor) const;
  /// A part whose admittance is replaced by a resistance.
  Effect replaced(std::size_t part, double siemens) const;
  /// Another admittance g + c s between two nodes.
  Stamp admittance(const std::string& from, const std::string& to, double g, double c) const;
  /// Adds g + c s to 1/A(s) of an op-amp.
  Stamp slower(std::size_t opamp, double g, double c) const;
  /// An op-amp with `factor` times its gain-bandwidth; its second pole is as much lower. `known`: the factor is
  /// all that its gain-bandwidth varies by.
  Effect slowed(std::size_t opamp, double factor, bool known) const;
  /// V(plus) has `part` of a node's voltage added.
  Stamp plus_follows(std::size_t opamp, const std::string& node, double part) const;
  /// An op-amp whose inputs follow each other but for `kept`, which is left of its gain at all frequencies: its own
  /// gain-bandwidth is part of that number then.
  Effect inputs_follow(std::size_t opamp, double kept) const;

 protected:
  std::vector<Fault> faults_of(const FaultKind& kind) const override { return kind.on_circuit(*this); }

 private:
  struct Unknown {
    std::string name;
    bool part = false;
    Stamp stamp;  ///< what one standard deviation adds, to first order
  };
  struct Point {
    Complex s;
    int out = 0;  ///< row of the node that is read
    Eigen::MatrixXcd inverse;
    Eigen::VectorXcd x;  ///< solution of the good board
  };
  void solve(const schematic::Equations& equations, RadPerSecond w, int out);
  void find_unknowns(const CircuitBoard* like);
  /// So many times a part's own admittance in parallel with it.
  Stamp times_admittance(std::size_t part, double factor) const;
  int node(const std::string& name) const;
  /// Solutions with some faults built in.
  class Changed;
  static Complex at(const Point& point, const Effect& effect, int row);
  static Eigen::VectorXcd outputs(const std::vector<Point>& points, const Effect& effect);

  schematic::Netlist circuit_;
  schematic::OpAmpModel model_;
  Spread spread_;
  std::map<std::string, int> nodes_;
  std::vector<Point> points_;
  std::vector<Unknown> unknowns_;
  std::vector<std::size_t> unknown_of_part_;
  std::vector<std::size_t> unknown_of_opamp_;  ///< gain-bandwidth; the second pole follows
};

}  // namespace bodesmith::faults
