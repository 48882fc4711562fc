#include "synthesis/ladders/rc_ladder.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>
#include <utility>

namespace bodesmith::synthesis {

std::complex<double> RcImpedance::operator()(std::complex<double> s) const {
  std::complex<double> out = high;
  for (std::size_t i = 0; i < poles.size(); ++i) out *= (s + zeros[i]) / (s + poles[i]);
  return out;
}

namespace ladder_synthesis {

Scaled scaled(const RcImpedance& z) {
  Scaled out;
  out.high = z.high;
  out.centre = std::sqrt(static_cast<Real>(z.poles.front()) * z.zeros.back());
  for (const double pole : z.poles) out.poles.push_back(pole / out.centre);
  for (const double zero : z.zeros) out.zeros.push_back(zero / out.centre);
  return out;
}

Polynomial from_roots(const std::vector<Real>& roots) {
  Polynomial out = {1.0L};
  for (const Real root : roots) {
    Polynomial next(out.size() + 1, 0.0L);
    for (std::size_t i = 0; i < out.size(); ++i) {
      next[i] += root * out[i];
      next[i + 1] += out[i];
    }
    out = std::move(next);
  }
  return out;
}

std::vector<Real> continued_fraction(Polynomial p, Polynomial q) {
  std::vector<Real> out;
  while (!q.empty() && !p.empty()) {
    const std::size_t shift = p.size() - q.size();
    const Real quotient = p.back() / q.back();
    out.push_back(quotient);
    for (std::size_t i = 0; i < q.size(); ++i) p[i + shift] -= quotient * q[i];
    p.pop_back();
    std::swap(p, q);
  }
  return out;
}

void Drawing::resistor(const std::string& from, const std::string& to, Real value) {
  parts_.push_back({true, fmt::format("R{}", ++resistors_), from, to, static_cast<double>(value)});
}

void Drawing::capacitor(const std::string& from, const std::string& to, Real value) {
  parts_.push_back({false, fmt::format("C{}", ++capacitors_), from, to, static_cast<double>(value)});
}

}  // namespace ladder_synthesis

RcImpedance impedance_of(const std::vector<LadderPart>& parts) {
  using Matrix = Eigen::Matrix<ladder_synthesis::Real, Eigen::Dynamic, Eigen::Dynamic>;
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
    for (const ladder_synthesis::Real value : solver.eigenvalues()) out.push_back(static_cast<double>(value));
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
