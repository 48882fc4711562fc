#include "simulate/propagators/linear.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bodesmith::simulate {
namespace {

/// Below this order the full matrix is as fast.
constexpr std::size_t kLeastModes = 5;
/// Up to this order the full matrix has a loop of its own.
constexpr std::size_t kMostFixed = 12;
/// Those of one system and its differences; of holds of several lengths.
constexpr std::size_t kMostPrepared = 6;

}  // namespace

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

void LinearPropagator::prepare(const chain::LinearKernel& system, double h, const HoldNodes& nodes,
                               bool keeps_states) {
  order_ = system.order();
  degree_ = nodes.degree;
  gain_ = system.d;
  offset_ = system.offset;
  delayed_ = system.delay_s > 0.0;
  const std::size_t width = nodes.size();
  shift_.assign(width, 0);
  next_.resize(order_);
  by_modes_ = false;
  if (!keeps_states && order_ >= kLeastModes && prepare_modes(system, h, nodes)) return;
  seen_ = system.c;
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

bool LinearPropagator::prepare_modes(const chain::LinearKernel& system, double h, const HoldNodes& nodes) {
  ModalPropagator::Output outputs[kMaxDegree + 1];
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Source source = source_of(i, system.delay_s / h, nodes);
    shift_[i] = source.shift;
    outputs[i].s = source.s;
    nodes.weights(source.s, outputs[i].weights);
  }
  by_modes_ = modal_.prepare(system, h, nodes, {outputs, nodes.size()});
  return by_modes_;
}

template <std::size_t N, std::size_t P>
void LinearPropagator::run_fixed(const double* u, double* y, std::size_t holds, double* x) {
  double c[(P + 1) * N];
  double d[(P + 1) * (P + 1)];
  double k[P + 1];
  double e[N * N];  // by columns, so that the rows of a product run side by side
  double g[N * (P + 1)];
  double kx[N];
  double state[N];
  std::copy_n(c_rows_.data(), (P + 1) * N, c);
  std::copy_n(d_rows_.data(), (P + 1) * (P + 1), d);
  std::copy_n(k_rows_.data(), P + 1, k);
  for (std::size_t a = 0; a < N; ++a) {
    for (std::size_t b = 0; b < N; ++b) e[b * N + a] = end_.e[a * N + b];
    for (std::size_t j = 0; j <= P; ++j) g[j * N + a] = end_.g[0][a * (P + 1) + j];
  }
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
    for (std::size_t a = 0; a < N; ++a) after[a] = kx[a];
    for (std::size_t j = 0; j <= P; ++j)
      for (std::size_t a = 0; a < N; ++a) after[a] += g[j * N + a] * v[j];
    for (std::size_t b = 0; b < N; ++b)
      for (std::size_t a = 0; a < N; ++a) after[a] += e[b * N + a] * state[b];
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
      {1, 1, &LinearPropagator::run_fixed<1, 1>},   {1, 3, &LinearPropagator::run_fixed<1, 3>},
      {2, 1, &LinearPropagator::run_fixed<2, 1>},   {2, 3, &LinearPropagator::run_fixed<2, 3>},
      {3, 1, &LinearPropagator::run_fixed<3, 1>},   {3, 3, &LinearPropagator::run_fixed<3, 3>},
      {4, 1, &LinearPropagator::run_fixed<4, 1>},   {4, 3, &LinearPropagator::run_fixed<4, 3>},
      {6, 3, &LinearPropagator::run_fixed<6, 3>},   {8, 3, &LinearPropagator::run_fixed<8, 3>},
      {10, 3, &LinearPropagator::run_fixed<10, 3>}, {12, 3, &LinearPropagator::run_fixed<12, 3>}};
  for (const Size& size : kSizes) {
    if (size.order != order_ || size.degree != degree_) continue;
    (this->*size.run)(u, y, holds, x);
    return true;
  }
  return false;
}

void LinearPropagator::run(const double* u, double* y, std::size_t holds, double* x, double before) {
  if (by_modes_) return run_modes(u, y, holds, x, before);
  if (!delayed_ && run_fixed_size(u, y, holds, x)) return;
  run_any(u, y, holds, x, before);
}

void LinearPropagator::run_modes(const double* u, double* y, std::size_t holds, const double* x,
                                 double before) {
  modal_.start(x);
  if (!delayed_) {
    modal_.run(u, y, holds);
    return;
  }
  const std::size_t width = degree_ + 1;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t shift = std::min(shift_[i], holds);
    for (std::size_t hold = 0; hold < shift; ++hold) y[hold * width + i] = before;
  }
  constexpr std::size_t kBlock = 64;
  double block[kBlock * (kMaxDegree + 1)];
  for (std::size_t first = 0; first < holds; first += kBlock) {
    const std::size_t count = std::min(kBlock, holds - first);
    modal_.run(u + first * width, block, count);
    for (std::size_t i = 0; i < width; ++i) {
      for (std::size_t hold = 0; hold < count; ++hold) {
        const std::size_t target = first + hold + shift_[i];
        if (target < holds) y[target * width + i] = block[hold * width + i];
      }
    }
  }
}

// z[i+1] = E z[i] + (E g1 + g0) u[i] + k, as ModalPropagator::run_straight.
template <std::size_t N, bool Lower>
void LinearPropagator::run_straight(double* signal, std::size_t count, const double* x) {
  constexpr std::size_t kPairs = (N + 1) / 2;
  constexpr std::size_t kRows = 2 * kPairs;
  double e[N * kRows] = {};  // by columns
  double in[kRows] = {}, constant[kRows] = {}, see[kRows] = {}, z[kRows] = {};
  double gain = gain_;
  for (std::size_t a = 0; a < N; ++a) {
    const double end = end_.g[0][2 * a + 1];
    in[a] = end_.g[0][2 * a];
    for (std::size_t b = 0; b < N; ++b) {
      e[b * kRows + a] = end_.e[a * N + b];
      in[a] += end_.e[a * N + b] * end_.g[0][2 * b + 1];
    }
    constant[a] = end_.k[a];
    see[a] = seen_[a];
    gain += seen_[a] * end;
    z[a] = x[a] - end * signal[0];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double u = signal[i];
    TwoLanes next[kPairs];
    TwoLanes sum = {offset_ + gain * u, 0.0};
    for (std::size_t k = 0; k < kPairs; ++k) {
      next[k] = load_lanes(constant + 2 * k) + load_lanes(in + 2 * k) * both_lanes(u);
      sum += load_lanes(see + 2 * k) * load_lanes(z + 2 * k);
    }
    for (std::size_t b = 0; b < N; ++b) {
      const TwoLanes state = both_lanes(z[b]);
      // First-order blocks in series: a state moves only itself and those behind it.
      for (std::size_t k = Lower ? b / 2 : 0; k < kPairs; ++k)
        next[k] += load_lanes(e + b * kRows + 2 * k) * state;
    }
    for (std::size_t k = 0; k < kPairs; ++k) {
      z[2 * k] = next[k][0];
      z[2 * k + 1] = next[k][1];
    }
    signal[i] = sum[0] + sum[1];
  }
}

template <std::size_t... N>
void LinearPropagator::run_straight_of(std::index_sequence<N...> /*sizes*/, bool lower, double* signal,
                                       std::size_t count, const double* x) {
  using Run = void (LinearPropagator::*)(double*, std::size_t, const double*);
  static constexpr Run kFull[] = {&LinearPropagator::run_straight<N + 1, false>...};
  static constexpr Run kLower[] = {&LinearPropagator::run_straight<N + 1, true>...};
  (this->*(lower ? kLower : kFull)[order_ - 1])(signal, count, x);
}

void LinearPropagator::run_straight_any(double* signal, std::size_t count, const double* x) {
  const std::size_t n = order_;
  std::vector<double> state(x, x + n);
  for (std::size_t i = 0; i < count; ++i) {
    const double u = signal[i];
    const double after = i + 1 < count ? signal[i + 1] : u;
    double sum = offset_ + gain_ * u;
    for (std::size_t a = 0; a < n; ++a) {
      sum += seen_[a] * state[a];
      double value = end_.k[a] + end_.g[0][2 * a] * u + end_.g[0][2 * a + 1] * after;
      for (std::size_t b = 0; b < n; ++b) value += end_.e[a * n + b] * state[b];
      next_[a] = value;
    }
    std::swap(state, next_);
    signal[i] = sum;
  }
}

void LinearPropagator::run_samples(double* signal, std::size_t count, const double* x) {
  if (count == 0) return;
  if (order_ == 0) {
    for (std::size_t i = 0; i < count; ++i) signal[i] = gain_ * signal[i] + offset_;
    return;
  }
  if (by_modes_) {
    modal_.start(x);
    modal_.run_samples(signal, count);
    return;
  }
  if (order_ > kMostFixed) return run_straight_any(signal, count, x);
  bool lower = true;
  for (std::size_t a = 0; a < order_; ++a) {
    for (std::size_t b = a + 1; b < order_; ++b) lower = lower && end_.e[a * order_ + b] == 0.0;
  }
  run_straight_of(std::make_index_sequence<kMostFixed>(), lower, signal, count, x);
}

LinearPropagator& PreparedPropagators::of(const chain::LinearKernel& system, double h, const HoldNodes& nodes,
                                          bool keeps_states) {
  for (Prepared& one : all_) {
    if (one.h == h && one.degree == nodes.degree && one.keeps_states == keeps_states && one.system == system)
      return one.by;
  }
  if (all_.size() < kMostPrepared) all_.emplace_back();
  Prepared& next = all_[oldest_];
  oldest_ = (oldest_ + 1) % kMostPrepared;
  next.system = system;
  next.h = h;
  next.degree = nodes.degree;
  next.keeps_states = keeps_states;
  next.by.prepare(system, h, nodes, keeps_states);
  return next.by;
}

}  // namespace bodesmith::simulate
