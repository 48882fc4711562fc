#include "simulate/record/exact_propagator.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bodesmith::simulate {

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
    for (std::size_t j = 0; j < kBlock; ++j) {
      const Mode e = std::exp(system_.poles[k] * (step_ * static_cast<double>(j)));
      power_real_[k * kBlock + j] = e.real();
      power_imag_[k * kBlock + j] = e.imag();
    }
    block_power_[k] = std::exp(system_.poles[k] * (step_ * static_cast<double>(kBlock)));
    if (system_.poles[k].imag() != 0.0) system_.residues[k] *= 2.0;
  }
}

void ExactPropagator::rest_under(double u) {
  for (std::size_t k = 0; k < state_.size(); ++k) state_[k] = -system_.residues[k] * u / system_.poles[k];
}

void ExactPropagator::fast_mode(std::size_t k, Mode q, Mode r, const Segment& segment) {
  // Particular solution from the top: q a_m = (m+1) a_{m+1} - r f_m. `a` passes through all a_m; at m = 0 it
  // is the solution at the beginning.
  const auto descend = [&](auto&& each) {
    Mode a = 0.0;
    for (std::size_t m = segment.degree + 1; m-- > 0;) {
      a = (static_cast<double>(m + 1) * a - r * segment.coefficients[m]) / q;
      each(m, a);
    }
    return a;
  };
  const Mode begin = descend([&](std::size_t m, Mode a) { sum_[m] += a.real(); });
  amplitude_[k] = state_[k] - begin;
  // Its value at the end: sum of all a_m, worked out again to keep no array.
  Mode end = 0.0;
  descend([&](std::size_t, Mode a) { end += a; });
  state_[k] = end + amplitude_[k] * std::exp(q);
}

void ExactPropagator::slow_mode(std::size_t k, Mode q, Mode r, const Segment& segment) {
  Mode x = state_[k];
  Mode total = x;
  sum_[0] += x.real();
  for (std::size_t m = 0; m < kTaylor; ++m) {
    x = (q * x + (m <= segment.degree ? r * segment.coefficients[m] : Mode())) / static_cast<double>(m + 1);
    sum_[m + 1] += x.real();
    total += x;
  }
  amplitude_[k] = 0.0;
  state_[k] = total;
  sum_degree_ = kTaylor;
}

void ExactPropagator::polynomial_of(const Segment& segment) {
  const double length = segment.end - segment.begin;
  std::fill(sum_, sum_ + kTaylor + 1, 0.0);
  sum_degree_ = segment.degree;
  for (std::size_t m = 0; m <= segment.degree; ++m) sum_[m] = system_.direct * segment.coefficients[m];
  for (std::size_t k = 0; k < state_.size(); ++k) {
    const Mode q = system_.poles[k] * length;  // pole in units of the segment
    const Mode r = system_.residues[k] * length;
    if (std::abs(q) > 1.5) {
      fast_mode(k, q, r, segment);
    } else {
      slow_mode(k, q, r, segment);
    }
  }
  // Rounding apart, the series ends early when the slow modes are slow.
  double size = 0.0;
  for (std::size_t m = 0; m <= sum_degree_; ++m) size = std::max(size, std::abs(sum_[m]));
  while (sum_degree_ > segment.degree && std::abs(sum_[sum_degree_]) <= 1e-18 * size) --sum_degree_;
}

void ExactPropagator::write_polynomial(double first, double scale, std::span<double> output) const {
  // Eight samples side by side, so that the products need not wait for each other.
  std::size_t i = 0;
  for (; i + kBlock <= output.size(); i += kBlock) {
    double s[kBlock];
    double v[kBlock];
    for (std::size_t j = 0; j < kBlock; ++j) {
      s[j] = first + scale * static_cast<double>(i + j);
      v[j] = sum_[sum_degree_];
    }
    for (std::size_t m = sum_degree_; m-- > 0;) {
      for (std::size_t j = 0; j < kBlock; ++j) v[j] = v[j] * s[j] + sum_[m];
    }
    for (std::size_t j = 0; j < kBlock; ++j) output[i + j] = v[j];
  }
  for (; i < output.size(); ++i) {
    const double s = first + scale * static_cast<double>(i);
    double v = sum_[sum_degree_];
    for (std::size_t m = sum_degree_; m-- > 0;) v = v * s + sum_[m];
    output[i] = v;
  }
}

void ExactPropagator::add_real(std::size_t k, double start, std::size_t count, double* output) const {
  const std::size_t whole = count / kBlock;
  const double step = block_power_[k].real();
  const double end = negligible(k);
  double power[kBlock];
  std::copy_n(power_real_.data() + k * kBlock, kBlock, power);
  double re = start;
  std::size_t b = 0;
  for (; b < whole && std::abs(re) > end; ++b, output += kBlock) {
    for (std::size_t j = 0; j < kBlock; ++j) output[j] += re * power[j];
    re *= step;
  }
  if (b < whole) return;
  for (std::size_t j = 0; j < count - whole * kBlock; ++j) output[j] += re * power[j];
}

void ExactPropagator::add_pair(std::size_t k, Mode start, std::size_t count, double* output) const {
  const std::size_t whole = count / kBlock;
  const double* power_re = power_real_.data() + k * kBlock;
  const double* power_im = power_imag_.data() + k * kBlock;
  const double step_re = block_power_[k].real();
  const double step_im = block_power_[k].imag();
  const double end = negligible(k);
  double re = start.real();
  double im = start.imag();
  std::size_t b = 0;
  for (; b < whole && std::abs(re) + std::abs(im) > end; ++b, output += kBlock) {
    for (std::size_t j = 0; j < kBlock; ++j) output[j] += re * power_re[j] - im * power_im[j];
    const double next = re * step_re - im * step_im;
    im = re * step_im + im * step_re;
    re = next;
  }
  if (b < whole) return;
  for (std::size_t j = 0; j < count - whole * kBlock; ++j) output[j] += re * power_re[j] - im * power_im[j];
}

void ExactPropagator::add_exponentials(double first, std::size_t count, double* output) const {
  for (std::size_t k = 0; k < state_.size(); ++k) {
    if (amplitude_[k] == Mode()) continue;
    const Mode start = amplitude_[k] * std::exp(system_.poles[k] * first);
    if (system_.poles[k].imag() == 0.0) {
      add_real(k, start.real(), count, output);
    } else {
      add_pair(k, start, count, output);
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
    const std::span<double> out = output.subspan(next, end - next);
    const double scale = step_ / length;
    const double first = (start_s - segment.begin) / length + static_cast<double>(next) * scale;
    write_polynomial(first, scale, out);
    add_exponentials(first * length, out.size(), out.data());
    next = end;
  }
  return next;
}

}  // namespace bodesmith::simulate
