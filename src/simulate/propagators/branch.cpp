#include "simulate/propagators/branch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bodesmith::simulate {
namespace {

/// Differences below this share of the signal are rounding, not a turn.
constexpr double kRounding = 1e-12;
/// Switch times this near to a hold's end belong to the end.
constexpr double kAtEnd = 1e-9;

/// Gauss-Legendre, five points on [0, 1].
constexpr std::array<double, 5> kAt = {0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155,
                                       0.953089922969332};
constexpr std::array<double, 5> kWeight = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                           0.23931433524968324, 0.11846344252809454};

/// Roots of c + b s + a s^2 inside (0, 1), rising.
std::size_t quadratic_roots(double a, double b, double c, double* roots) {
  const double inside = b * b - 4.0 * a * c;
  if (inside <= 0.0) return 0;
  std::size_t count = 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(inside), b));
  for (const double r : {a != 0.0 ? q / a : -1.0, q != 0.0 ? c / q : -1.0}) {
    if (r > 0.0 && r < 1.0) roots[count++] = r;
  }
  if (count == 2 && roots[1] < roots[0]) std::swap(roots[0], roots[1]);
  return count;
}

}  // namespace

double BranchPropagator::on_branch(double u) const {
  return memory_->on_branch(branch_, u);
}

void BranchPropagator::turn(double when, bool rising) {
  if (rising == rising_) return;
  rising_ = rising;
  due_.push_back(when + delay_);
}

bool BranchPropagator::is_constant(const double* v) const {
  return std::all_of(v + 1, v + nodes_->size(), [v](double value) { return value == v[0]; });
}

bool BranchPropagator::is_monotone(const double* v) const {
  const auto falls = [](double a, double b) { return a > b; };
  const double* const end = v + nodes_->size();
  return std::is_sorted(v, end) || std::is_sorted(v, end, falls);
}

void BranchPropagator::find_turns(const double* v, double last, double noise, const double* next) {
  const std::size_t p = nodes_->degree;
  if (std::abs(v[0] - last) > noise) turn(0.0, v[0] > last);
  if (is_constant(v)) return;  // behind a clocked hold most are
  // The slope's polynomial, and the directions between its roots.
  double slope[3] = {};
  double roots[3];
  std::size_t count = 0;
  if (p == 3) {
    for (std::size_t k = 1; k <= p; ++k) {
      for (std::size_t j = 0; j <= p; ++j)
        slope[k - 1] += static_cast<double>(k) * nodes_->monomial[k][j] * v[j];
    }
    count = quadratic_roots(slope[2], slope[1], slope[0], roots);
  }
  roots[count] = 1.0;
  const bool doubted = place_.kinked && is_monotone(v);
  const auto is_so = [&](bool rising, bool at_end) {
    if (!doubted || rising == (v[p] > v[0])) return true;
    return at_end && next != nullptr && (rising ? next[1] - next[0] : next[0] - next[1]) > noise;
  };
  double from = 0.0;
  double value = v[0];
  for (std::size_t k = 0; k <= count; ++k) {
    const double end = roots[k] < 1.0 ? nodes_->value(v, roots[k]) : v[p];
    if (std::abs(end - value) > noise && is_so(end > value, k == count)) turn(from, end > value);
    from = roots[k];
    value = end;
  }
}

double BranchPropagator::run(const chain::MemoryKernel& memory, const HoldNodes& nodes,
                             std::span<const HoldSpan> spans, double* signal, double before, Place place) {
  memory_ = &memory;
  place_ = place;
  nodes_ = &nodes;
  for (std::size_t j = 0; j <= nodes.degree; ++j) {
    quadrature_[j] = 0.0;
    for (std::size_t k = 0; k <= nodes.degree; ++k)
      quadrature_[j] += nodes.monomial[k][j] / static_cast<double>(k + 1);
  }
  const std::size_t width = nodes.size();
  rising_ = branch_ = true;
  due_.clear();
  const double rest = on_branch(before);
  double size = std::abs(before);
  double last = before;
  double* v = signal;
  double h = spans.front().h;
  for (const HoldSpan& span : spans) {
    for (double& time : due_) time *= h / span.h;
    h = span.h;
    delay_ = memory.switch_delay_s() / h;
    for (std::size_t hold = 0; hold < span.holds; ++hold, v += width) {
      for (std::size_t j = 0; j < width; ++j) size = std::max(size, std::abs(v[j]));
      const bool ends = &span == &spans.back() && hold + 1 == span.holds;
      find_turns(v, last, kRounding * size, ends ? nullptr : v + width);
      last = v[width - 1];
      run_hold(v);
      for (double& time : due_) time -= 1.0;
    }
  }
  return rest;
}

void BranchPropagator::run_hold(double* v) {
  const std::size_t width = nodes_->size();
  switch_until(kAtEnd);
  if (!due_.empty() && due_.front() < 1.0 - kAtEnd)
    return place_.values_only ? values_of_broken_hold(v) : broken_hold(v);
  if (is_constant(v)) {
    std::fill_n(v, width, on_branch(v[0]));
  } else {
    for (std::size_t j = 0; j < width; ++j) v[j] = on_branch(v[j]);
  }
}

void BranchPropagator::switch_until(double at) {
  while (!due_.empty() && due_.front() <= at) {
    branch_ = !branch_;
    due_.erase(due_.begin());
  }
}

void BranchPropagator::values_of_broken_hold(double* v) {
  for (std::size_t j = 0; j < nodes_->size(); ++j) {
    switch_until(nodes_->at[j]);
    v[j] = on_branch(v[j]);
  }
}

void BranchPropagator::moments(const double* v, double* moment) {
  const std::size_t inner = nodes_->degree - 1;
  double from = 0.0;
  while (true) {
    const bool more = !due_.empty() && due_.front() < 1.0 - kAtEnd;
    const double to = more ? due_.front() : 1.0;
    for (std::size_t i = 0; i < kAt.size(); ++i) {
      const double s = from + (to - from) * kAt[i];
      double term = (to - from) * kWeight[i] * on_branch(nodes_->value(v, s));
      for (std::size_t m = 0; m < inner; ++m, term *= s) moment[m] += term;
    }
    if (!more) return;
    branch_ = !branch_;
    due_.erase(due_.begin());
    from = to;
  }
}

void BranchPropagator::solve_inner_nodes(const double* moment, double* v) const {
  const std::size_t p = nodes_->degree;
  const std::size_t inner = p - 1;
  // sum over the inner nodes of weight_j s_j^m y_j = moment_m - (the ends' part)
  double system[kMaxDegree][kMaxDegree + 1] = {};
  for (std::size_t m = 0; m < inner; ++m) {
    for (std::size_t j = 1; j < p; ++j)
      system[m][j - 1] = quadrature_[j] * std::pow(nodes_->at[j], static_cast<double>(m));
    system[m][inner] = moment[m] - (m == 0 ? quadrature_[0] * v[0] : 0.0) - quadrature_[p] * v[p];
  }
  for (std::size_t k = 0; k < inner; ++k) {
    for (std::size_t i = k + 1; i < inner; ++i) {
      const double f = system[i][k] / system[k][k];
      for (std::size_t j = k; j <= inner; ++j) system[i][j] -= f * system[k][j];
    }
  }
  for (std::size_t k = inner; k-- > 0;) {
    double sum = system[k][inner];
    for (std::size_t j = k + 1; j < inner; ++j) sum -= system[k][j] * v[j + 1];
    v[k + 1] = sum / system[k][k];
  }
}

void BranchPropagator::broken_hold(double* v) {
  const double first = on_branch(v[0]);
  double moment[kMaxDegree] = {};
  moments(v, moment);
  v[0] = first;
  v[nodes_->degree] = on_branch(v[nodes_->degree]);
  solve_inner_nodes(moment, v);
}

}  // namespace bodesmith::simulate
