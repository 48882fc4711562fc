#include "chain/linear_kernel.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace bodesmith::chain {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const RowMatrix> matrix(const LinearKernel& k) {
  return {k.a.data(), k.order, k.order};
}
Eigen::Map<const Eigen::VectorXd> vector(const std::vector<double>& v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

/// x' = P (u - x), y = direct u + through x.
LinearKernel first_order(double pole, double direct, double through) {
  LinearKernel k;
  k.order = 1;
  k.a = {-pole};
  k.b = {pole};
  k.c = {through};
  k.d = direct;
  return k;
}

}  // namespace

LinearKernel gain_kernel(double gain, double offset) {
  LinearKernel k;
  k.d = gain;
  k.offset = offset;
  return k;
}

LinearKernel pole_zero_kernel(double gain, double zero_rad_s, double pole_rad_s) {
  const double direct = std::isinf(zero_rad_s) ? 0.0 : pole_rad_s / zero_rad_s;
  return first_order(pole_rad_s, gain * direct, gain * (1.0 - direct));
}

LinearKernel section_kernel(const Section& section) {
  const auto& p = section.poles;
  const auto& z = section.zeros;
  if (p.empty()) return gain_kernel(section.gain);
  const bool real_poles = std::all_of(p.begin(), p.end(), [](auto r) { return r.imag() == 0.0; });
  const bool real_zeros = std::all_of(z.begin(), z.end(), [](auto r) { return r.imag() == 0.0; });
  // k (s - z)/(s + P) = k + k (-z - P)/P * P/(s + P)
  const auto one = [](double gain, const double* zero, double pole) {
    const double corner = -pole;
    if (zero == nullptr) return first_order(corner, 0.0, gain / corner);
    return first_order(corner, gain, gain * (-*zero - corner) / corner);
  };
  if (p.size() == 1) {
    const double zero = z.empty() ? 0.0 : z[0].real();
    return one(section.gain, z.empty() ? nullptr : &zero, p[0].real());
  }
  if (real_poles && real_zeros) {
    const double z0 = z.empty() ? 0.0 : z[0].real();
    const double z1 = z.size() < 2 ? 0.0 : z[1].real();
    return in_series(one(section.gain, z.empty() ? nullptr : &z0, p[0].real()),
                     one(1.0, z.size() < 2 ? nullptr : &z1, p[1].real()));
  }
  // x1 = a0/(s^2 + a1 s + a0) u, x2 = s/w0 x1
  const double a1 = -(p[0] + p[1]).real();
  const double a0 = (p[0] * p[1]).real();
  const double w0 = std::sqrt(a0);
  LinearKernel k;
  k.order = 2;
  k.a = {0.0, w0, -w0, -a1};
  k.b = {0.0, w0};
  if (z.size() == 2) {
    const double b1 = -(z[0] + z[1]).real();
    const double b0 = (z[0] * z[1]).real();
    k.c = {section.gain * (b0 - a0) / a0, section.gain * (b1 - a1) / w0};
    k.d = section.gain;
  } else if (z.size() == 1) {
    k.c = {section.gain * -z[0].real() / a0, section.gain / w0};
  } else {
    k.c = {section.gain / a0, 0.0};
  }
  return k;
}

LinearKernel sections_kernel(const Sections& sections) {
  LinearKernel k = gain_kernel(sections.gain);
  for (const Section& section : sections.sections) k = in_series(k, section_kernel(section));
  return k;
}

LinearKernel in_series(const LinearKernel& first, const LinearKernel& second) {
  const auto m = static_cast<size_t>(first.order);
  const auto n = static_cast<size_t>(second.order);
  const size_t total = m + n;
  LinearKernel k;
  k.order = static_cast<int>(total);
  k.a.assign(total * total, 0.0);
  k.b.resize(total);
  k.c.resize(total);
  for (size_t i = 0; i < m; ++i) {
    for (size_t j = 0; j < m; ++j) k.a[i * total + j] = first.a[i * m + j];
    k.b[i] = first.b[i];
    k.c[i] = second.d * first.c[i];
  }
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < m; ++j) k.a[(m + i) * total + j] = second.b[i] * first.c[j];
    for (size_t j = 0; j < n; ++j) k.a[(m + i) * total + m + j] = second.a[i * n + j];
    k.b[m + i] = second.b[i] * first.d;
    k.c[m + i] = second.c[i];
  }
  k.d = first.d * second.d;
  if (total > 0 && (first.offset != 0.0 || !first.constant.empty() || !second.constant.empty())) {
    k.constant.assign(total, 0.0);
    for (size_t i = 0; i < m && !first.constant.empty(); ++i) k.constant[i] = first.constant[i];
    for (size_t i = 0; i < n; ++i) {
      k.constant[m + i] = second.b[i] * first.offset + (second.constant.empty() ? 0.0 : second.constant[i]);
    }
  }
  k.offset = second.offset + second.d * first.offset;
  k.delay_s = first.delay_s + second.delay_s;
  k.approximation_error = first.approximation_error + second.approximation_error;
  return k;
}

std::complex<double> response(const LinearKernel& k, std::complex<double> s) {
  std::complex<double> h = k.d;
  if (k.order > 0) {
    const Eigen::MatrixXcd left =
        s * Eigen::MatrixXcd::Identity(k.order, k.order) - matrix(k).cast<std::complex<double>>();
    const Eigen::VectorXcd x = left.partialPivLu().solve(vector(k.b).cast<std::complex<double>>());
    h += (vector(k.c).cast<std::complex<double>>().transpose() * x)(0);
  }
  return h * std::exp(-s * k.delay_s);
}

void equilibrium(const LinearKernel& k, double u, double* x) {
  if (k.order == 0) return;
  if (k.order == 1) {
    x[0] = -(k.b[0] * u + (k.constant.empty() ? 0.0 : k.constant[0])) / k.a[0];
    return;
  }
  Eigen::VectorXd drive = vector(k.b) * u;
  if (!k.constant.empty()) drive += vector(k.constant);
  const Eigen::VectorXd solved = -matrix(k).partialPivLu().solve(drive);
  std::copy(solved.begin(), solved.end(), x);
}

}  // namespace bodesmith::chain
