#include "simulate/linear_propagator.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::simulate {

void LinearPropagator::prepare(const chain::LinearKernel& system, double h, const HoldNodes& nodes) {
  const int n = order_ = static_cast<int>(system.order());
  const int p = degree_ = nodes.degree;
  gain_ = system.d;
  offset_ = system.offset;
  delayed_ = system.delay_s > 0.0;
  const auto rows = static_cast<size_t>(p + 1);
  shift_.assign(rows, 0);
  next_.resize(static_cast<size_t>(n));
  if (n == 0 && !delayed_) return;
  const std::vector<const double*> inputs = {system.b.data()};
  if (n > 0) solver_.solve(system, inputs, h, nodes, 1.0, end_);
  c_rows_.assign(rows * static_cast<size_t>(n), 0.0);
  d_rows_.assign(rows * rows, 0.0);
  k_rows_.assign(rows, 0.0);
  const double delay = system.delay_s / h;
  for (int i = 0; i <= p; ++i) {
    // Output node i looks at the time (hold + at) - delay of the input: hold `shift` earlier, part s of it.
    // The last node belongs to what was before it, the others to what follows.
    const double when = nodes.at[i] - delay;
    double whole = i == p ? std::ceil(when) - 1.0 : std::floor(when);
    double s = when - whole;
    constexpr double kClose = 1e-12;
    if (i < p && s > 1.0 - kClose) {
      whole += 1.0;
      s = 0.0;
    }
    if (i == p && s < kClose) {
      whole -= 1.0;
      s = 1.0;
    }
    shift_[static_cast<size_t>(i)] = static_cast<size_t>(-whole);
    double w[kMaxDegree + 1];
    nodes.weights(s, w);
    for (int j = 0; j <= p; ++j)
      d_rows_[static_cast<size_t>(i) * rows + static_cast<size_t>(j)] = system.d * w[j];
    double constant = system.offset;
    if (n > 0) {
      const HoldResponse* r = &end_;
      if (s != 1.0) {
        solver_.solve(system, inputs, h, nodes, s, inner_);
        r = &inner_;
      }
      for (int a = 0; a < n; ++a) {
        const double c = system.c[static_cast<size_t>(a)];
        for (int b = 0; b < n; ++b)
          c_rows_[static_cast<size_t>(i * n + b)] += c * r->e[static_cast<size_t>(a * n + b)];
        for (int j = 0; j <= p; ++j) {
          d_rows_[static_cast<size_t>(i) * rows + static_cast<size_t>(j)] +=
              c * r->g[0][static_cast<size_t>(a * (p + 1) + j)];
        }
        constant += c * r->k[static_cast<size_t>(a)];
      }
    }
    k_rows_[static_cast<size_t>(i)] = constant;
  }
}

template <int N, int P>
void LinearPropagator::run_fixed(const double* u, double* y, std::size_t holds, double* x) const {
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
    for (int j = 0; j <= P; ++j) v[j] = u[j];
    for (int i = 0; i <= P; ++i) {
      double sum = k[i];
      for (int j = 0; j <= P; ++j) sum += d[i * (P + 1) + j] * v[j];
      for (int a = 0; a < N; ++a) sum += c[i * N + a] * state[a];
      y[i] = sum;
    }
    double after[N];
    for (int a = 0; a < N; ++a) {
      double sum = kx[a];
      for (int j = 0; j <= P; ++j) sum += g[a * (P + 1) + j] * v[j];
      for (int b = 0; b < N; ++b) sum += e[a * N + b] * state[b];
      after[a] = sum;
    }
    for (int a = 0; a < N; ++a) state[a] = after[a];
    u += P + 1;
    y += P + 1;
  }
  std::copy_n(state, N, x);
}

void LinearPropagator::run_any(const double* u, double* y, std::size_t holds, double* x,
                               double before) const {
  const int n = order_;
  const int width = degree_ + 1;
  for (int i = 0; i < width; ++i) {
    const std::size_t shift = std::min(shift_[static_cast<size_t>(i)], holds);
    for (std::size_t hold = 0; hold < shift; ++hold)
      y[hold * static_cast<size_t>(width) + static_cast<size_t>(i)] = before;
  }
  for (std::size_t hold = 0; hold < holds; ++hold) {
    for (int i = 0; i < width; ++i) {
      const std::size_t target = hold + shift_[static_cast<size_t>(i)];
      if (target >= holds) continue;
      double sum = k_rows_[static_cast<size_t>(i)];
      const double* d = d_rows_.data() + i * width;
      const double* c = c_rows_.data() + i * n;
      for (int j = 0; j < width; ++j) sum += d[j] * u[j];
      for (int a = 0; a < n; ++a) sum += c[a] * x[a];
      y[target * static_cast<size_t>(width) + static_cast<size_t>(i)] = sum;
    }
    for (int a = 0; a < n; ++a) {
      double sum = end_.k[static_cast<size_t>(a)];
      const double* g = end_.g[0].data() + a * width;
      const double* e = end_.e.data() + a * n;
      for (int j = 0; j < width; ++j) sum += g[j] * u[j];
      for (int b = 0; b < n; ++b) sum += e[b] * x[b];
      next_[static_cast<size_t>(a)] = sum;
    }
    std::copy(next_.begin(), next_.end(), x);
    u += width;
  }
}

void LinearPropagator::run(const double* u, double* y, std::size_t holds, double* x, double before) const {
  if (order_ == 0 && !delayed_) {
    const std::size_t count = holds * static_cast<size_t>(degree_ + 1);
    for (std::size_t i = 0; i < count; ++i) y[i] = gain_ * u[i] + offset_;
    return;
  }
  if (!delayed_) {
    switch (10 * order_ + degree_) {
      case 11:
        return run_fixed<1, 1>(u, y, holds, x);
      case 12:
        return run_fixed<1, 2>(u, y, holds, x);
      case 13:
        return run_fixed<1, 3>(u, y, holds, x);
      case 14:
        return run_fixed<1, 4>(u, y, holds, x);
      case 21:
        return run_fixed<2, 1>(u, y, holds, x);
      case 22:
        return run_fixed<2, 2>(u, y, holds, x);
      case 23:
        return run_fixed<2, 3>(u, y, holds, x);
      case 24:
        return run_fixed<2, 4>(u, y, holds, x);
      case 31:
        return run_fixed<3, 1>(u, y, holds, x);
      case 33:
        return run_fixed<3, 3>(u, y, holds, x);
      case 41:
        return run_fixed<4, 1>(u, y, holds, x);
      case 43:
        return run_fixed<4, 3>(u, y, holds, x);
      default:
        break;
    }
  }
  run_any(u, y, holds, x, before);
}

}  // namespace bodesmith::simulate
