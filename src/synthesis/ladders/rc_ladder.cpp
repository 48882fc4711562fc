#include "synthesis/ladders/rc_ladder.hpp"

#include <cmath>
#include <map>

#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::synthesis {

std::complex<double> RcImpedance::operator()(std::complex<double> s) const {
  std::complex<double> out = high;
  for (std::size_t i = 0; i < poles.size(); ++i) out *= (s + zeros[i]) / (s + poles[i]);
  return out;
}

RcImpedance impedance_of(const std::vector<LadderPart>& parts) {
  using Eigen::MatrixXd;
  std::map<std::string, Eigen::Index> places = {{"b", -1}, {"a", 0}};
  Eigen::Index nodes = 1, capacitors = 0;
  for (const LadderPart& one : parts) {
    for (const std::string& node : {one.from, one.to})
      nodes += places.try_emplace(node, nodes).second ? 1 : 0;
    capacitors += one.resistor ? 0 : 1;
  }
  // Conductances between the nodes, b at ground; the capacitors' ends and roots of their inverse values.
  MatrixXd siemens = MatrixXd::Zero(nodes, nodes), ends = MatrixXd::Zero(nodes, capacitors);
  MatrixXd root = MatrixXd::Zero(capacitors, capacitors);
  Eigen::Index k = 0;
  for (const LadderPart& one : parts) {
    Eigen::VectorXd along = Eigen::VectorXd::Zero(nodes);
    if (const Eigen::Index at = places.at(one.from); at >= 0) along(at) += 1.0;
    if (const Eigen::Index at = places.at(one.to); at >= 0) along(at) -= 1.0;
    if (one.resistor) {
      siemens += along * along.transpose() / one.value;
    } else {
      ends.col(k) = along;
      root(k, k) = 1.0 / std::sqrt(one.value);
      ++k;
    }
  }
  const auto frequencies = [&](Eigen::Index seen) {
    const MatrixXd at = ends.bottomRows(seen);
    const MatrixXd ohm = times(at.transpose(), solve_ldlt_columns(siemens.bottomRightCorner(seen, seen), at));
    const Eigen::VectorXd values = symmetric_eigen(times(root, solve_ldlt_columns(ohm, root))).values;
    return std::vector<double>(values.begin(), values.end());
  };
  // Z at the terminals less what the capacitors short at high frequencies.
  MatrixXd all(nodes, capacitors + 1);
  all << MatrixXd::Identity(nodes, 1), ends;
  const MatrixXd z = times(all.transpose(), solve_ldlt_columns(siemens, all));
  const Eigen::VectorXd at_terminals = z.bottomLeftCorner(capacitors, 1);
  const Eigen::VectorXd shorted = solve_ldlt(z.bottomRightCorner(capacitors, capacitors), at_terminals);
  return {frequencies(nodes), frequencies(nodes - 1), z(0, 0) - at_terminals.dot(shorted)};
}

}  // namespace bodesmith::synthesis
