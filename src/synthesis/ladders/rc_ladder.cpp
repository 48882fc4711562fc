#include "synthesis/ladders/rc_ladder.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

namespace bodesmith::synthesis {

std::complex<double> RcImpedance::operator()(std::complex<double> s) const {
  std::complex<double> out = high;
  for (std::size_t i = 0; i < poles.size(); ++i) out *= (s + zeros[i]) / (s + poles[i]);
  return out;
}

RcImpedance impedance_of(const std::vector<LadderPart>& parts) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  std::map<std::string, Eigen::Index> places = {{"b", -1}, {"a", 0}};
  Eigen::Index nodes = 1, capacitors = 0;
  for (const LadderPart& one : parts) {
    for (const std::string& node : {one.from, one.to})
      nodes += places.try_emplace(node, nodes).second ? 1 : 0;
    capacitors += one.resistor ? 0 : 1;
  }
  // Conductances between the nodes, b at ground; the capacitors' ends and inverse values.
  Matrix siemens = Matrix::Zero(nodes, nodes), ends = Matrix::Zero(nodes, capacitors);
  Matrix elastance = Matrix::Zero(capacitors, capacitors);
  Eigen::Index k = 0;
  for (const LadderPart& one : parts) {
    Matrix along = Matrix::Zero(nodes, 1);
    if (const Eigen::Index at = places.at(one.from); at >= 0) along(at) += 1.0L;
    if (const Eigen::Index at = places.at(one.to); at >= 0) along(at) -= 1.0L;
    if (one.resistor) {
      siemens += along * along.transpose() / one.value;
    } else {
      ends.col(k) = along;
      elastance(k, k) = 1.0L / one.value;
      ++k;
    }
  }
  const auto frequencies = [&](Eigen::Index seen) {
    const Matrix at = ends.bottomRows(seen);
    const Matrix ohm = at.transpose() * siemens.bottomRightCorner(seen, seen).llt().solve(at);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(elastance, ohm, Eigen::EigenvaluesOnly);
    std::vector<double> out;
    for (const long double value : solver.eigenvalues()) out.push_back(static_cast<double>(value));
    return out;
  };
  // Z at the terminals less what the capacitors short at high frequencies.
  Matrix all(nodes, capacitors + 1);
  all << Matrix::Identity(nodes, 1), ends;
  const Matrix z = all.transpose() * siemens.llt().solve(all);
  const Matrix shorted =
      z.bottomRightCorner(capacitors, capacitors).llt().solve(z.bottomLeftCorner(capacitors, 1));
  return {frequencies(nodes), frequencies(nodes - 1),
          static_cast<double>(z(0, 0) - (z.topRightCorner(1, capacitors) * shorted)(0, 0))};
}

}  // namespace bodesmith::synthesis
