#include "circuit/network.hpp"

#include <stdexcept>

namespace bodesmith::circuit {

Network::Network(const Circuit& circuit) : circuit_(circuit) {
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

void Network::number(const std::string& name) {
  if (name != "0" && name != "in") nodes_.try_emplace(name, static_cast<int>(nodes_.size()));
}

int Network::node(const std::string& name) const {
  if (name == "0") return kGround;
  if (name == "in") return kInput;
  return nodes_.at(name);
}

SparseSystem Network::system(RadPerSecond w, const OpAmpModel* model) const {
  const Eigen::Index n = nodes();
  const Eigen::Index m = static_cast<Eigen::Index>(circuit_.opamps.size());
  SparseSystem out{{}, Eigen::VectorXcd::Zero(n + m)};
  const auto add = [&](Eigen::Index row, int column, Complex value) {
    if (column == kGround) return;
    if (column == kInput) {
      out.b(row) -= value;
    } else {
      out.add(row, column, value);
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
    const int at = node(opamp.out);
    out.add(at, n + i, -1.0);  // its current flows into the node
    add(n + i, node(opamp.plus), 1.0);
    add(n + i, node(opamp.minus), -1.0);
    if (model != nullptr) {
      // v+ - v- = (v_out + Ro i)/A
      const Complex inverse = 1.0 / model->open_loop(w);
      add(n + i, at, -inverse);
      out.add(n + i, n + i, -inverse * model->output_resistance_ohm);
    }
  }
  return out;
}

Network::Complex Network::output(RadPerSecond w, const OpAmpModel* model) const {
  return solve_sparse(system(w, model))(node("out"));
}

}  // namespace bodesmith::circuit
