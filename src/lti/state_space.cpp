#include "lti/state_space.hpp"

#include <Eigen/Core>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const RowMatrix> matrix_of(const StateSpace& system) {
  return {system.a.data(), eigen_index(system.order()), eigen_index(system.order())};
}

/// x' = corner (u - x), y = direct u + through x.
StateSpace first_order(double corner, double direct, double through) {
  StateSpace out;
  out.a = {-corner};
  out.b = {corner};
  out.c = {through};
  out.d = direct;
  return out;
}

/// gain (s - zero)/(s - pole), or gain/(s - pole):
/// g (s - z)/(s + w) = g + g (-z - w)/w * w/(s + w).
StateSpace real_pole(double gain, const double* zero, double pole) {
  const double corner = -pole;
  if (zero == nullptr) return first_order(corner, 0.0, gain / corner);
  return first_order(corner, gain, gain * (-*zero - corner) / corner);
}

/// x1 = a0/(s^2 + a1 s + a0) u, x2 = s/w0 x1.
StateSpace pole_pair(const Section& section) {
  const auto& p = section.poles;
  const auto& z = section.zeros;
  const double a1 = -(p[0] + p[1]).real();
  const double a0 = (p[0] * p[1]).real();
  const double w0 = std::sqrt(a0);
  StateSpace out;
  out.a = {0.0, w0, -w0, -a1};
  out.b = {0.0, w0};
  if (z.size() == 2) {
    const double b1 = -(z[0] + z[1]).real();
    const double b0 = (z[0] * z[1]).real();
    out.c = {section.gain * (b0 - a0) / a0, section.gain * (b1 - a1) / w0};
    out.d = section.gain;
  } else if (z.size() == 1) {
    out.c = {section.gain * -z[0].real() / a0, section.gain / w0};
  } else {
    out.c = {section.gain / a0, 0.0};
  }
  return out;
}

bool all_real(const std::vector<Complex>& roots) {
  return std::ranges::all_of(roots, [](auto r) { return r.imag() == 0.0; });
}

}  // namespace

Complex response(const StateSpace& system, Complex s) {
  if (system.order() == 0) return system.d;
  const Eigen::Index n = eigen_index(system.order());
  const Eigen::MatrixXcd left = s * Eigen::MatrixXcd::Identity(n, n) - matrix_of(system).cast<Complex>();
  const Eigen::VectorXcd x = solve_lu(left, as_eigen(system.b).cast<Complex>());
  return system.d + (as_eigen(system.c).cast<Complex>().transpose() * x)(0);
}

void equilibrium(const StateSpace& system, double u, double* x) {
  if (system.order() == 0) return;
  if (system.order() == 1) {
    x[0] = -(system.b[0] * u + (system.constant.empty() ? 0.0 : system.constant[0])) / system.a[0];
    return;
  }
  Eigen::VectorXd drive = as_eigen(system.b) * u;
  if (!system.constant.empty()) drive += as_eigen(system.constant);
  const Eigen::VectorXd at_rest = -solve_lu(matrix_of(system), drive);
  std::copy(at_rest.begin(), at_rest.end(), x);
}

StateSpace gain_system(double gain, double offset) {
  StateSpace out;
  out.d = gain;
  out.offset = offset;
  return out;
}

StateSpace state_space(const Section& section) {
  const auto& p = section.poles;
  const auto& z = section.zeros;
  if (p.empty()) return gain_system(section.gain);
  const double z0 = z.empty() ? 0.0 : z[0].real();
  if (p.size() == 1) return real_pole(section.gain, z.empty() ? nullptr : &z0, p[0].real());
  if (!all_real(p) || !all_real(z)) return pole_pair(section);
  const double z1 = z.size() < 2 ? 0.0 : z[1].real();
  return in_series(real_pole(section.gain, z.empty() ? nullptr : &z0, p[0].real()),
                   real_pole(1.0, z.size() < 2 ? nullptr : &z1, p[1].real()));
}

StateSpace state_space(const Sections& sections) {
  StateSpace out = gain_system(sections.gain);
  for (const Section& section : sections.sections) out = in_series(out, state_space(section));
  return out;
}

StateSpace in_series(const StateSpace& first, const StateSpace& second) {
  const std::size_t m = first.order();
  const std::size_t n = second.order();
  const std::size_t total = m + n;
  StateSpace out;
  out.a.assign(total * total, 0.0);
  out.b.resize(total);
  out.c.resize(total);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) out.a[i * total + j] = first.a[i * m + j];
    out.b[i] = first.b[i];
    out.c[i] = second.d * first.c[i];
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) out.a[(m + i) * total + j] = second.b[i] * first.c[j];
    for (std::size_t j = 0; j < n; ++j) out.a[(m + i) * total + m + j] = second.a[i * n + j];
    out.b[m + i] = second.b[i] * first.d;
    out.c[m + i] = second.c[i];
  }
  out.d = first.d * second.d;
  if (total > 0 && (first.offset != 0.0 || !first.constant.empty() || !second.constant.empty())) {
    out.constant.assign(total, 0.0);
    std::copy(first.constant.begin(), first.constant.end(), out.constant.begin());
    for (std::size_t i = 0; i < n; ++i) {
      out.constant[m + i] = second.b[i] * first.offset + (second.constant.empty() ? 0.0 : second.constant[i]);
    }
  }
  out.offset = second.offset + second.d * first.offset;
  return out;
}

}  // namespace bodesmith
