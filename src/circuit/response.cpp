#include "circuit/response.hpp"

#include <Eigen/Dense>
#include <map>
#include <stdexcept>

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// Modified nodal analysis: unknowns are the node voltages and one output current an op-amp; row 0.. of the
/// nodes are Kirchhoff's current law, the rest the op-amps' equations. V(in) = 1 is known.
class Network {
 public:
  explicit Network(const Circuit& circuit) : circuit_(circuit) {
    for (const Part& part : circuit.parts) {
      number(part.from);
      number(part.to);
    }
    for (const OpAmp& opamp : circuit.opamps) {
      number(opamp.plus);
      number(opamp.minus);
      number(opamp.out);
    }
    if (!nodes_.contains("out")) throw std::logic_error("a circuit without an output");
  }

  /// `gain`(w) of the op-amps, or nullors when `ideal`.
  Complex solve(RadPerSecond w, const OpAmpModel* model) const {
    const Eigen::Index n = static_cast<Eigen::Index>(nodes_.size());
    const Eigen::Index m = static_cast<Eigen::Index>(circuit_.opamps.size());
    Eigen::MatrixXcd a = Eigen::MatrixXcd::Zero(n + m, n + m);
    Eigen::VectorXcd b = Eigen::VectorXcd::Zero(n + m);
    const auto add = [&](Eigen::Index row, int node, Complex value) {
      if (row < 0 || node == kGround) return;
      if (node == kInput) {
        b(row) -= value;
      } else {
        a(row, node) += value;
      }
    };
    for (const Part& part : circuit_.parts) {
      const Complex y = part.kind == Part::Kind::resistor ? Complex(1.0 / part.realised, 0.0)
                                                          : Complex(0.0, w.value * part.realised);
      const int p = node(part.from), q = node(part.to);
      if (p >= 0) {
        add(p, p, y);
        add(p, q, -y);
      }
      if (q >= 0) {
        add(q, q, y);
        add(q, p, -y);
      }
    }
    for (Eigen::Index i = 0; i < m; ++i) {
      const OpAmp& opamp = circuit_.opamps[static_cast<size_t>(i)];
      const int out = node(opamp.out);
      a(out, n + i) -= 1.0;  // its current flows into the node
      if (model == nullptr) {
        add(n + i, node(opamp.plus), 1.0);
        add(n + i, node(opamp.minus), -1.0);
      } else {
        // v+ - v- = (v_out + Ro i)/A
        const Complex inverse = 1.0 / model->open_loop(w);
        add(n + i, node(opamp.plus), 1.0);
        add(n + i, node(opamp.minus), -1.0);
        add(n + i, out, -inverse);
        a(n + i, n + i) -= inverse * model->output_resistance_ohm;
      }
    }
    const Eigen::VectorXcd x = a.partialPivLu().solve(b);
    return x(node("out"));
  }

 private:
  static constexpr int kGround = -1;
  static constexpr int kInput = -2;

  void number(const std::string& name) {
    if (name != "0" && name != "in") nodes_.try_emplace(name, static_cast<int>(nodes_.size()));
  }
  int node(const std::string& name) const {
    if (name == "0") return kGround;
    if (name == "in") return kInput;
    return nodes_.at(name);
  }

  const Circuit& circuit_;
  std::map<std::string, int> nodes_;
};

std::vector<Complex> over(const Circuit& circuit, const std::vector<Hertz>& grid, const OpAmpModel* model) {
  const Network network(circuit);
  std::vector<Complex> out;
  out.reserve(grid.size());
  for (const Hertz f : grid) out.push_back(network.solve(f.rad_s(), model));
  return out;
}

}  // namespace

std::vector<Complex> network_response(const Circuit& circuit, const std::vector<Hertz>& grid,
                                      const OpAmpModel& model) {
  return over(circuit, grid, &model);
}

std::vector<Complex> network_response_ideal(const Circuit& circuit, const std::vector<Hertz>& grid) {
  return over(circuit, grid, nullptr);
}

std::vector<Complex> circuit_response(const Circuit& circuit, const std::vector<Hertz>& grid) {
  std::vector<Complex> out;
  out.reserve(grid.size());
  for (const Hertz f : grid) out.push_back(circuit.response(f.rad_s()));
  return out;
}

}  // namespace bodesmith
