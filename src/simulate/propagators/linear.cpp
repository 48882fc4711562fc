#include "simulate/propagators/linear.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bodesmith::simulate {

LinearPropagator::Source LinearPropagator::source_of(std::size_t node, double delay,
                                                     const HoldNodes& nodes) const {
  // Output node i looks at the time (hold + at) - delay of the input. The last node belongs to what was
  // before it, the others to what follows.
  constexpr double kClose = 1e-12;
  const bool last = node == nodes.degree;
  const double when = nodes.at[node] - delay;
  double whole = last ? std::ceil(when) - 1.0 : std::floor(when);
  double s = when - whole;
  if (!last && s > 1.0 - kClose) {
    whole += 1.0;
    s = 0.0;
  }
  if (last && s < kClose) {
    whole -= 1.0;
    s = 1.0;
  }
  return {static_cast<std::size_t>(-whole), s};
}

void LinearPropagator::set_row(std::size_t node, const chain::LinearKernel& system, const double* weights,
                               const HoldResponse& response) {
  const std::size_t n = order_;
  const std::size_t width = degree_ + 1;
  for (std::size_t j = 0; j < width; ++j) d_rows_[node * width + j] = system.d * weights[j];
  double constant = system.offset;
  for (std::size_t a = 0; a < n; ++a) {
    const double c = system.c[a];
    for (std::size_t b = 0; b < n; ++b) c_rows_[node * n + b] += c * response.e[a * n + b];
    for (std::size_t j = 0; j < width; ++j) d_rows_[node * width + j] += c * response.g[0][a * width + j];
    constant += c * response.k[a];
  }
  k_rows_[node] = constant;
}

void LinearPropagator::prepare(const chain::LinearKernel& system, double h, const HoldNodes& nodes) {
  order_ = system.order();
  degree_ = nodes.degree;
  gain_ = system.d;
  offset_ = system.offset;
  delayed_ = system.delay_s > 0.0;
  const std::size_t width = nodes.size();
  shift_.assign(width, 0);
  next_.resize(order_);
  if (order_ == 0 && !delayed_) return;
  const std::array<const double*, 1> inputs = {system.b.data()};
  const DrivenSystem dynamics = driven(system, inputs);
  if (order_ > 0) solver_.solve(dynamics, h, nodes, 1.0, end_);
  c_rows_.assign(width * order_, 0.0);
  d_rows_.assign(width * width, 0.0);
  k_rows_.assign(width, 0.0);
  for (std::size_t i = 0; i < width; ++i) {
    const Source source = source_of(i, system.delay_s / h, nodes);
    shift_[i] = source.shift;
    double weights[kMaxDegree + 1];
    nodes.weights(source.s, weights);
    const bool at_end = source.s == 1.0;
    if (order_ > 0 && !at_end) solver_.solve(dynamics, h, nodes, source.s, inner_);
    set_row(i, system, weights, at_end ? end_ : inner_);
  }
}

template <std::size_t N, std::size_t P>
void LinearPropagator::run_fixed(const double* u, double* y, std::size_t holds, double* x) {
  double c[(P + 1) * N];
  double d[(P + 1) * (P + 1)];
  double k[P + 1];
  double e[N * N];
  double g[N * (P + 1)];
  double kx[N];
  double state[N];
  std::copy_n(c_rows_.data(), (P + 1) * N, c);
  std::copy_n(d_rows_.data(), (P + 1) * (P + 1), d);
  std::copy_n(k_rows_.data(), P + 1, k);
  std::copy_n(end_.e.data(), N * N, e);
  std::copy_n(end_.g[0].data(), N * (P + 1), g);
  std::copy_n(end_.k.data(), N, kx);
  std::copy_n(x, N, state);
  for (std::size_t hold = 0; hold < holds; ++hold) {
    double v[P + 1];
    for (std::size_t j = 0; j <= P; ++j) v[j] = u[j];
    for (std::size_t i = 0; i <= P; ++i) {
      double sum = k[i];
      for (std::size_t j = 0; j <= P; ++j) sum += d[i * (P + 1) + j] * v[j];
      for (std::size_t a = 0; a < N; ++a) sum += c[i * N + a] * state[a];
      y[i] = sum;
    }
    double after[N];
    for (std::size_t a = 0; a < N; ++a) {
      double sum = kx[a];
      for (std::size_t j = 0; j <= P; ++j) sum += g[a * (P + 1) + j] * v[j];
      for (std::size_t b = 0; b < N; ++b) sum += e[a * N + b] * state[b];
      after[a] = sum;
    }
    for (std::size_t a = 0; a < N; ++a) state[a] = after[a];
    u += P + 1;
    y += P + 1;
  }
  std::copy_n(state, N, x);
}

void LinearPropagator::run_any(const double* u, double* y, std::size_t holds, double* x, double before) {
  const std::size_t n = order_;
  const std::size_t width = degree_ + 1;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t shift = std::min(shift_[i], holds);
    for (std::size_t hold = 0; hold < shift; ++hold) y[hold * width + i] = before;
  }
  for (std::size_t hold = 0; hold < holds; ++hold) {
    for (std::size_t i = 0; i < width; ++i) {
      const std::size_t target = hold + shift_[i];
      if (target >= holds) continue;
      double sum = k_rows_[i];
      const double* d = d_rows_.data() + i * width;
      const double* c = c_rows_.data() + i * n;
      for (std::size_t j = 0; j < width; ++j) sum += d[j] * u[j];
      for (std::size_t a = 0; a < n; ++a) sum += c[a] * x[a];
      y[target * width + i] = sum;
    }
    for (std::size_t a = 0; a < n; ++a) {
      double sum = end_.k[a];
      const double* g = end_.g[0].data() + a * width;
      const double* e = end_.e.data() + a * n;
      for (std::size_t j = 0; j < width; ++j) sum += g[j] * u[j];
      for (std::size_t b = 0; b < n; ++b) sum += e[b] * x[b];
      next_[a] = sum;
    }
    std::copy(next_.begin(), next_.end(), x);
    u += width;
  }
}

bool LinearPropagator::run_fixed_size(const double* u, double* y, std::size_t holds, double* x) {
  struct Size {
    std::size_t order, degree;
    void (LinearPropagator::*run)(const double*, double*, std::size_t, double*);
  };
  static constexpr Size kSizes[] = {
      {1, 1, &LinearPropagator::run_fixed<1, 1>}, {1, 2, &LinearPropagator::run_fixed<1, 2>},
      {1, 3, &LinearPropagator::run_fixed<1, 3>}, {1, 4, &LinearPropagator::run_fixed<1, 4>},
      {2, 1, &LinearPropagator::run_fixed<2, 1>}, {2, 2, &LinearPropagator::run_fixed<2, 2>},
      {2, 3, &LinearPropagator::run_fixed<2, 3>}, {2, 4, &LinearPropagator::run_fixed<2, 4>},
      {3, 1, &LinearPropagator::run_fixed<3, 1>}, {3, 3, &LinearPropagator::run_fixed<3, 3>},
      {4, 1, &LinearPropagator::run_fixed<4, 1>}, {4, 3, &LinearPropagator::run_fixed<4, 3>}};
  for (const Size& size : kSizes) {
    if (size.order != order_ || size.degree != degree_) continue;
    (this->*size.run)(u, y, holds, x);
    return true;
  }
  return false;
}

void LinearPropagator::run(const double* u, double* y, std::size_t holds, double* x, double before) {
  if (order_ == 0 && !delayed_) {
    const std::size_t count = holds * (degree_ + 1);
    for (std::size_t i = 0; i < count; ++i) y[i] = gain_ * u[i] + offset_;
    return;
  }
  if (!delayed_ && run_fixed_size(u, y, holds, x)) return;
  run_any(u, y, holds, x, before);
}

}  // namespace bodesmith::simulate
