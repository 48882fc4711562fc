#pragma once

#include <Eigen/Core>
#include <complex>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "numeric/linear_algebra/sparse.hpp"
#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {

/// What an analysis takes for granted.
struct Assumptions {
  bool ideal_opamps = false;  ///< nullors
  bool ideal_diodes = false;
  int position = 0;                 ///< of the switch: which contacts are closed
  bool switching = false;           ///< comparators, gates and contacts act; `position` counts for nothing
  std::string input = "in";         ///< node that is driven from outside
  const Deviations* off = nullptr;  ///< none: as realised
};

/// Modified nodal analysis: the unknowns are the node voltages, in the order in which parts, op-amps, multipliers, contacts
/// and sources name them, then a current for every op-amp, multiplier and source; `switching`, the levels of the switches'
/// control come behind them: a current for every comparator and gate, a timer for every contact.
///   f(x) + d/dt q(x) = 0  (elements/element.hpp)
/// Keeps nothing of the netlist.
class Equations {
 public:
  explicit Equations(const Netlist& netlist, const Assumptions& assumptions = {});

  int node(const std::string& name) const;  ///< its place; throws std::logic_error where there is none
  bool has(const std::string& name) const { return name == "0" || nodes_.contains(name) || name == input_; }
  Eigen::Index nodes() const { return static_cast<Eigen::Index>(nodes_.size()); }
  Eigen::Index unknowns() const { return static_cast<Eigen::Index>(count_); }
  Eigen::Index row_of_opamp(std::size_t opamp) const { return nodes() + static_cast<Eigen::Index>(opamp); }
  const std::vector<std::unique_ptr<Element>>& elements() const { return elements_; }
  /// Element of Netlist::parts[part].
  const Element& part(std::size_t part) const { return *elements_[part]; }

  /// Nodes that ideal sources hold, with the rows of their currents.
  struct Held {
    int node, branch;
  };
  const std::vector<Held>& held() const { return held_; }

  /// f, q and their slopes at a point.
  void evaluate(const Point& at, std::span<double> f, std::span<double> q,
                std::vector<Stamps::Slope>& slopes) const;
  /// Small signals are about this point from now on; before it about 0.
  void linearise(const std::vector<double>& x, double input_v);
  /// The same, the voltages by name; nodes that are not there are at 0.
  void linearise(const std::map<std::string, double>& volts);

  /// (df/dx + jw dq/dx) x = what 1 V at the input adds.
  SparseSystem small_signal(RadPerSecond w) const;
  /// V(node) for 1 V at the input.
  Complex response(RadPerSecond w, const std::string& node = "out") const;
  /// V(node) for 1 in each row: how everything reaches the node (one solution of the transposed system).
  Eigen::VectorXcd ways_to(RadPerSecond w, const std::string& node = "out") const;

 private:
  void number(const std::string& name);
  void add_opamps(const Netlist& netlist, const Assumptions& assumptions);
  void add_contacts(const Netlist& netlist, const Assumptions& assumptions);
  void add_levels(const Netlist& netlist);
  /// A new row for what an ideal source at a node delivers.
  int hold(const std::string& node);

  std::string input_;
  std::map<std::string, int> nodes_;
  std::size_t count_ = 0;
  std::vector<std::unique_ptr<Element>> elements_;
  std::vector<Held> held_;
  std::vector<Stamps::Slope> slopes_;  ///< about the point
};

}  // namespace bodesmith::schematic
