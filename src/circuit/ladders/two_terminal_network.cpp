#include "circuit/ladders/two_terminal_network.hpp"

#include <Eigen/Core>
#include <map>

#include "numeric/dense.hpp"

namespace bodesmith::circuit {

std::complex<double> impedance_between(const std::vector<TwoTerminalPart>& parts, const std::string& a,
                                       const std::string& b, RadPerSecond w) {
  std::map<std::string, int> nodes;
  for (const TwoTerminalPart& part : parts) {
    for (const std::string& node : {part.from, part.to}) {
      if (node != b) nodes.try_emplace(node, static_cast<int>(nodes.size()));
    }
  }
  const Eigen::Index n = static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXcd y = Eigen::MatrixXcd::Zero(n, n);
  for (const TwoTerminalPart& part : parts) {
    const std::complex<double> g = part.resistor ? std::complex<double>(1.0 / part.value, 0.0)
                                                 : std::complex<double>(0.0, w.value * part.value);
    const int p = part.from == b ? -1 : nodes.at(part.from), q = part.to == b ? -1 : nodes.at(part.to);
    if (p >= 0) y(p, p) += g;
    if (q >= 0) y(q, q) += g;
    if (p >= 0 && q >= 0) {
      y(p, q) -= g;
      y(q, p) -= g;
    }
  }
  Eigen::VectorXcd current = Eigen::VectorXcd::Zero(n);
  current(nodes.at(a)) = 1.0;
  return solve_lu(y, current)(nodes.at(a));
}

}  // namespace bodesmith::circuit
