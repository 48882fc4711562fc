#include "simulate/exact_propagator.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bodesmith::simulate {
namespace {

using Complex = std::complex<double>;

void set_condition(ModalSystem& m) {
  double modes = std::abs(m.direct);
  for (std::size_t k = 0; k < m.poles.size(); ++k) {
    modes += (m.poles[k].imag() != 0.0 ? 2.0 : 1.0) * std::abs(m.residues[k] / m.poles[k]);
  }
  double most = 0.0;
  const auto at = [&](double w) {
    Complex h = m.direct;
    for (std::size_t k = 0; k < m.poles.size(); ++k) {
      h += m.residues[k] / (Complex(0.0, w) - m.poles[k]);
      if (m.poles[k].imag() != 0.0) h += std::conj(m.residues[k]) / (Complex(0.0, w) - std::conj(m.poles[k]));
    }
    most = std::max(most, std::abs(h));
  };
  at(0.0);
  for (const Complex p : m.poles) at(std::abs(p));
  m.condition = m.poles.empty() ? 1.0 : modes / most;
  if (!std::isfinite(m.condition)) m.condition = std::numeric_limits<double>::infinity();
}

}  // namespace

ModalSystem ModalSystem::from(const Sections& sections) {
  std::vector<Complex> zeros;
  std::vector<Complex> poles;
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
    Complex r = gain;
    std::size_t z = 0;
    for (std::size_t j = 0; j < poles.size(); ++j) {
      if (j != k) r /= poles[k] - poles[j];
      if (z < zeros.size()) r *= poles[k] - zeros[z++];
    }
    m.poles.push_back(poles[k]);
    m.residues.push_back(r);
  }
  set_condition(m);
  return m;
}

ModalSystem ModalSystem::from(const StateSpace& kernel) {
  ModalSystem m;
  m.direct = kernel.d;
  const int n = static_cast<int>(kernel.order());
  if (n == 0) return m;
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> a(
      kernel.a.data(), n, n);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a);
  const Eigen::MatrixXcd v = solver.eigenvectors();
  const Eigen::Map<const Eigen::VectorXd> b(kernel.b.data(), n);
  const Eigen::Map<const Eigen::VectorXd> c(kernel.c.data(), n);
  const Eigen::FullPivLU<Eigen::MatrixXcd> lu(v);
  if (!lu.isInvertible() || solver.info() != Eigen::Success) {
    m.condition = std::numeric_limits<double>::infinity();
    return m;
  }
  const Eigen::VectorXcd in = lu.solve(b.cast<Complex>());
  const Eigen::RowVectorXcd out = c.cast<Complex>().transpose() * v;
  for (int k = 0; k < n; ++k) {
    const Complex p = solver.eigenvalues()(k);
    if (p.imag() < 0.0) continue;
    m.poles.push_back(p);
    m.residues.push_back(in(k)*out(k));
  }
  set_condition(m);
  return m;
}

ExactPropagator::ExactPropagator(ModalSystem system, double step_s)
    : system_(std::move(system)), step_(step_s) {
  if (!(step_s > 0.0)) throw std::logic_error("ExactPropagator: the step is not above 0");
  const std::size_t n = system_.poles.size();
  state_.assign(n, 0.0);
  amplitude_.assign(n, 0.0);
  block_power_.resize(n);
  power_real_.resize(n * kBlock);
  power_imag_.resize(n * kBlock);
  for (std::size_t k = 0; k < n; ++k) {
    // The residue (twice, for a pair) is folded into the states, so the output is their plain sum of real
    // parts.
    for (int j = 0; j < kBlock; ++j) {
      const Complex e = std::exp(system_.poles[k] * (step_ * j));
      power_real_[k * kBlock + static_cast<std::size_t>(j)] = e.real();
      power_imag_[k * kBlock + static_cast<std::size_t>(j)] = e.imag();
    }
    block_power_[k] = std::exp(system_.poles[k] * (step_ * kBlock));
    if (system_.poles[k].imag() != 0.0) system_.residues[k] *= 2.0;
  }
}

void ExactPropagator::reset() {
  std::fill(state_.begin(), state_.end(), Complex());
}

void ExactPropagator::rest_under(double u) {
  for (std::size_t k = 0; k < state_.size(); ++k) state_[k] = -system_.residues[k] * u / system_.poles[k];
}

void ExactPropagator::polynomial_of(const Segment& segment) {
  const double length = segment.end - segment.begin;
  const int degree = segment.degree;
  std::fill(sum_, sum_ + kTaylor + 1, 0.0);
  sum_degree_ = degree;
  for (int m = 0; m <= degree; ++m) sum_[m] = system_.direct * segment.coefficients[m];
  for (std::size_t k = 0; k < state_.size(); ++k) {
    const Complex q = system_.poles[k] * length;  // pole in units of the segment
    const Complex r = system_.residues[k] * length;
    if (std::abs(q) > 1.5) {
      // Particular solution from the top: q a_m = (m+1) a_{m+1} - r f_m.
      Complex a = 0.0;
      for (int m = degree; m >= 0; --m) {
        a = (static_cast<double>(m + 1) * a - r * segment.coefficients[m]) / q;
        sum_[m] += a.real();
        // `a` now is a_m; at m = 0 it is the particular solution at the beginning.
      }
      amplitude_[k] = state_[k] - a;
      // Its value at the end: sum of all a_m, worked out again to keep no array.
      Complex total = 0.0;
      a = 0.0;
      for (int m = degree; m >= 0; --m) {
        a = (static_cast<double>(m + 1) * a - r * segment.coefficients[m]) / q;
        total += a;
      }
      state_[k] = total + amplitude_[k] * std::exp(q);
    } else {
      Complex x = state_[k];
      Complex total = x;
      sum_[0] += x.real();
      for (int m = 0; m < kTaylor; ++m) {
        x = (q * x + (m <= degree ? r * segment.coefficients[m] : Complex())) / static_cast<double>(m + 1);
        sum_[m + 1] += x.real();
        total += x;
      }
      amplitude_[k] = 0.0;
      state_[k] = total;
      sum_degree_ = kTaylor;
    }
  }
  // Rounding apart, the series ends early when the slow modes are slow.
  double size = 0.0;
  for (int m = 0; m <= sum_degree_; ++m) size = std::max(size, std::abs(sum_[m]));
  while (sum_degree_ > degree && std::abs(sum_[sum_degree_]) <= 1e-18 * size) --sum_degree_;
}

void ExactPropagator::add_exponentials(double first, std::size_t count, double* output) {
  const std::size_t whole = count / kBlock;
  for (std::size_t k = 0; k < state_.size(); ++k) {
    if (amplitude_[k] == Complex()) continue;
    const Complex start = amplitude_[k] * std::exp(system_.poles[k] * first);
    double re = start.real();
    double im = start.imag();
    const double* pr = power_real_.data() + k * kBlock;
    const double* pi = power_imag_.data() + k * kBlock;
    const double sr = block_power_[k].real();
    const double si = block_power_[k].imag();
    // What is below 1e-22 of where it began no longer changes a sum of doubles; stopping also keeps denormals
    // away.
    const double least = 1e-22 * std::abs(amplitude_[k]);
    double* out = output;
    if (system_.poles[k].imag() == 0.0) {
      double p[kBlock];
      std::copy(pr, pr + kBlock, p);
      std::size_t b = 0;
      for (; b < whole && std::abs(re) > least; ++b, out += kBlock) {
        for (int j = 0; j < kBlock; ++j) out[j] += re * p[j];
        re *= sr;
      }
      if (b == whole) {
        for (std::size_t j = 0; j < count - whole * kBlock; ++j) out[j] += re * p[j];
      }
    } else {
      std::size_t b = 0;
      for (; b < whole && std::abs(re) + std::abs(im) > least; ++b, out += kBlock) {
        for (int j = 0; j < kBlock; ++j) out[j] += re * pr[j] - im * pi[j];
        const double next = re * sr - im * si;
        im = re * si + im * sr;
        re = next;
      }
      if (b == whole) {
        for (std::size_t j = 0; j < count - whole * kBlock; ++j) out[j] += re * pr[j] - im * pi[j];
      }
    }
  }
}

std::size_t ExactPropagator::run(std::span<const Segment> segments, double start_s,
                                 std::span<double> output) {
  std::size_t next = 0;
  for (const Segment& segment : segments) {
    const double length = segment.end - segment.begin;
    polynomial_of(segment);
    // Samples in (begin, end], to a rounding of the step.
    const double to = (segment.end - start_s) / step_ + 1e-9;
    const std::size_t end =
        std::min(output.size(), to < 0.0 ? std::size_t{0} : static_cast<std::size_t>(to) + 1);
    if (end <= next) continue;
    const std::size_t count = end - next;
    double* out = output.data() + next;
    const double scale = step_ / length;
    const double first = (start_s - segment.begin) / length + static_cast<double>(next) * scale;
    // Eight samples side by side, so that the products need not wait for each other.
    std::size_t i = 0;
    for (; i + kBlock <= count; i += kBlock) {
      double s[kBlock];
      double v[kBlock];
      for (int j = 0; j < kBlock; ++j) {
        s[j] = first + scale * static_cast<double>(i + static_cast<std::size_t>(j));
        v[j] = sum_[sum_degree_];
      }
      for (int m = sum_degree_ - 1; m >= 0; --m) {
        for (int j = 0; j < kBlock; ++j) v[j] = v[j] * s[j] + sum_[m];
      }
      for (int j = 0; j < kBlock; ++j) out[i + static_cast<std::size_t>(j)] = v[j];
    }
    for (; i < count; ++i) {
      const double s = first + scale * static_cast<double>(i);
      double v = sum_[sum_degree_];
      for (int m = sum_degree_ - 1; m >= 0; --m) v = v * s + sum_[m];
      out[i] = v;
    }
    add_exponentials(first * length, count, out);
    next = end;
  }
  return next;
}

}  // namespace bodesmith::simulate
