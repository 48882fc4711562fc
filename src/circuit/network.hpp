#pragma once

#include <Eigen/Core>
#include <complex>
#include <map>
#include <string>

#include "circuit/circuit.hpp"
#include "numeric/sparse.hpp"

namespace bodesmith::circuit {

/// Modified nodal analysis of a circuit: unknowns are the node voltages and one output current an op-amp; the
/// first rows are Kirchhoff's current law, the rest the op-amps' equations. V(in) = 1 is known.
class Network {
 public:
  using Complex = std::complex<double>;
  static constexpr int kGround = -1;
  static constexpr int kInput = -2;

  /// Keeps a reference to the circuit.
  explicit Network(const Circuit& circuit);

  /// `model` null: nullors.
  SparseSystem system(RadPerSecond w, const OpAmpModel* model) const;
  Complex output(RadPerSecond w, const OpAmpModel* model) const;

  int node(const std::string& name) const;
  Eigen::Index nodes() const { return static_cast<Eigen::Index>(nodes_.size()); }
  const Circuit& circuit() const { return circuit_; }

 private:
  void number(const std::string& name);

  const Circuit& circuit_;
  std::map<std::string, int> nodes_;
};

}  // namespace bodesmith::circuit
