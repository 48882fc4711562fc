#include "simulate/modal_system.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/dense.hpp"
#include "numeric/index.hpp"

namespace bodesmith::simulate {
namespace {

using ModalComplex = std::complex<double>;

}  // namespace

void ModalSystem::find_condition() {
  double modes = std::abs(direct);
  for (std::size_t k = 0; k < poles.size(); ++k) {
    modes += (poles[k].imag() != 0.0 ? 2.0 : 1.0) * std::abs(residues[k] / poles[k]);
  }
  double max_gain = 0.0;
  const auto at = [&](double w) {
    ModalComplex h = direct;
    for (std::size_t k = 0; k < poles.size(); ++k) {
      h += residues[k] / (ModalComplex(0.0, w) - poles[k]);
      if (poles[k].imag() != 0.0) h += std::conj(residues[k]) / (ModalComplex(0.0, w) - std::conj(poles[k]));
    }
    max_gain = std::max(max_gain, std::abs(h));
  };
  at(0.0);
  for (const ModalComplex p : poles) at(std::abs(p));
  condition = poles.empty() ? 1.0 : modes / max_gain;
  if (!std::isfinite(condition)) condition = std::numeric_limits<double>::infinity();
}

ModalSystem ModalSystem::from(const Sections& sections) {
  std::vector<ModalComplex> zeros;
  std::vector<ModalComplex> poles;
  double gain = sections.gain;
  for (const Section& s : sections.sections) {
    gain *= s.gain;
    zeros.insert(zeros.end(), s.zeros.begin(), s.zeros.end());
    poles.insert(poles.end(), s.poles.begin(), s.poles.end());
  }
  ModalSystem m;
  if (zeros.size() == poles.size()) m.direct = gain;
  for (std::size_t k = 0; k < poles.size(); ++k) {
    if (poles[k].imag() < 0.0) continue;
    // A zero over a pole at a time: no overflow for many roots.
    ModalComplex r = gain;
    std::size_t z = 0;
    for (std::size_t j = 0; j < poles.size(); ++j) {
      if (j != k) r /= poles[k] - poles[j];
      if (z < zeros.size()) r *= poles[k] - zeros[z++];
    }
    m.poles.push_back(poles[k]);
    m.residues.push_back(r);
  }
  m.find_condition();
  return m;
}

ModalSystem ModalSystem::from(const StateSpace& system) {
  ModalSystem m;
  m.direct = system.d;
  if (system.order() == 0) return m;
  const Eigen::Index n = eigen_index(system.order());
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> a(
      system.a.data(), n, n);
  const std::optional<EigenSystem> modes = eigen_system(a);
  const Eigen::FullPivLU<Eigen::MatrixXcd> lu(modes ? modes->vectors : Eigen::MatrixXcd::Zero(n, n));
  if (!modes || !lu.isInvertible()) {
    m.condition = std::numeric_limits<double>::infinity();
    return m;
  }
  const Eigen::VectorXcd in = lu.solve(as_eigen(system.b).cast<ModalComplex>());
  const Eigen::RowVectorXcd out = as_eigen(system.c).cast<ModalComplex>().transpose() * modes->vectors;
  for (Eigen::Index k = 0; k < n; ++k) {
    const ModalComplex p = modes->values(k);
    if (p.imag() < 0.0) continue;
    m.poles.push_back(p);
    m.residues.push_back(in(k)*out(k));
  }
  m.find_condition();
  return m;
}

}  // namespace bodesmith::simulate
