#include "simulate/propagators/sampled.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/whole_number.hpp"

namespace bodesmith::simulate {
namespace {

/// Node values of the polynomial of degree p that has the same p+1 moments over [0, 1] as a staircase:
/// shifted Legendre series, whose partial integrals are closed.
class Staircase {
 public:
  explicit Staircase(const HoldNodes& nodes) : nodes_(nodes) {
    for (std::size_t j = 0; j <= nodes.degree; ++j) legendre(2.0 * nodes.at[j] - 1.0, at_node_[j]);
  }
  /// From the hold's begin on.
  void clear() {
    std::fill(sum_, sum_ + kMaxDegree + 1, 0.0);
    from_ = 0.0;
    legendre(-1.0, low_);
  }
  /// The staircase is `value` from where it ended up to `to`.
  void add(double to, double value) {
    double high[kMaxDegree + 2];
    legendre(2.0 * to - 1.0, high);
    for (std::size_t k = 0; k <= nodes_.degree; ++k) {
      // (2k+1) int P_k(2s-1) ds = [P_{k+1} - P_{k-1}]/2
      const double before_low = k == 0 ? -1.0 : low_[k - 1];
      const double before_high = k == 0 ? -1.0 : high[k - 1];
      const double integral =
          k == 0 ? to - from_ : 0.5 * ((high[k + 1] - before_high) - (low_[k + 1] - before_low));
      sum_[k] += value * integral;
    }
    from_ = to;
    std::copy_n(high, nodes_.degree + 2, low_);
  }
  void nodes(double* y) const {
    for (std::size_t j = 0; j <= nodes_.degree; ++j) {
      y[j] = 0.0;
      for (std::size_t k = 0; k <= nodes_.degree; ++k) y[j] += sum_[k] * at_node_[j][k];
    }
  }

 private:
  void legendre(double x, double* p) const {
    p[0] = 1.0;
    p[1] = x;
    for (std::size_t k = 1; k <= nodes_.degree; ++k) {
      const auto n = static_cast<double>(k);
      const double part = (2.0 * n + 1.0) * x * p[k] - n * p[k - 1];
      // By powers of two without a division, to the same bits.
      p[k + 1] = k == 1 ? 0.5 * part : k == 3 ? 0.25 * part : part / (n + 1.0);
    }
  }
  const HoldNodes& nodes_;
  double from_ = 0.0;
  double low_[kMaxDegree + 2]{};
  double at_node_[kMaxDegree + 1][kMaxDegree + 2]{};
  double sum_[kMaxDegree + 1]{};
};

/// Edges this near to an end of a hold, in holds, belong to it.
constexpr double kClose = 1e-9;

}  // namespace

double run_memory(chain::MemoryKernel& memory, const HoldNodes& nodes, std::span<const HoldSpan> spans,
                  double* signal, std::optional<double> rest) {
  const std::size_t width = nodes.size();
  double* v = signal;
  double last_in = rest.value_or(v[0]);
  double last_out = memory.reset(last_in, rest.has_value());
  const double start = last_out;
  for (const HoldSpan& span : spans) {
    double gaps[kMaxDegree + 1] = {};
    for (std::size_t j = 1; j < width; ++j) gaps[j] = span.h * (nodes.at[j] - nodes.at[j - 1]);
    for (std::size_t hold = 0; hold < span.holds; ++hold, v += width) {
      if (v[0] != last_in) last_out = memory.step(v[0], 0.0);
      last_in = v[width - 1];
      v[0] = last_out;
      for (std::size_t j = 1; j < width; ++j) v[j] = memory.step(v[j], gaps[j]);
      last_out = v[width - 1];
    }
  }
  return start;
}

double run_memory(chain::MemoryKernel& memory, StepSignal& signal, std::optional<double> rest) {
  double last = rest.value_or(signal.value.front());
  const double start = memory.reset(last, rest.has_value());
  double y = start;
  for (double& v : signal.value) {
    if (v != last) y = memory.step(v, 0.0);
    last = v;
    v = y;
  }
  return start;
}

double run_memory(chain::MemoryKernel& memory, const StepSignal& signal, const HoldNodes& nodes, double h,
                  std::size_t holds, std::optional<double> rest, double* y) {
  const double start = memory.reset(rest.value_or(signal.value.front()), rest.has_value());
  double last = rest ? memory.step(signal.value.front(), 0.0) : start;
  double time = 0.0;
  std::size_t now = 0;
  const auto wait_until = [&](double t) {
    if (t > time) last = memory.step(signal.value[now], (t - time) * h);
    time = std::max(time, t);
  };
  for (std::size_t hold = 0; hold < holds; ++hold) {
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const double at = static_cast<double>(hold) + nodes.at[j];
      while (now + 1 < signal.at.size() && signal.at[now + 1] <= at) {
        wait_until(signal.at[now + 1]);
        last = memory.step(signal.value[++now], 0.0);
      }
      wait_until(at);
      *y++ = last;
    }
  }
  return start;
}

void run_sampled(chain::SampledKernel& kernel, const HoldNodes& nodes, double h, const double* u,
                 std::size_t holds, bool equilibrium, StepSignal& out) {
  const double cycle = 1.0 / (kernel.clock_hz() * h);
  const double lag = kernel.delay_s() / h;
  out.at.assign(1, 0.0);
  out.value.assign(1, kernel.reset(u[0], equilibrium));
  const auto end = static_cast<double>(holds);
  for (std::size_t k = 0;; ++k) {
    const double edge = static_cast<double>(k) * cycle;
    const double shows = edge + lag;
    if (!(shows < end - kClose)) break;
    // An edge at the end of a hold samples what is there before the next one begins.
    const std::size_t hold =
        k == 0 ? 0 : whole_number<std::size_t>(std::max(std::ceil(edge - kClose), 1.0)) - 1;
    const double s = std::clamp(edge - static_cast<double>(hold), 0.0, 1.0);
    const double value = kernel.update(nodes.value(u + hold * nodes.size(), s));
    if (shows <= kClose) {
      out.value.back() = value;
    } else {
      out.at.push_back(shows);
      out.value.push_back(value);
    }
  }
}

void spread_steps(const StepSignal& signal, const HoldNodes& nodes, double* y, std::size_t holds,
                  double* jumps) {
  const std::size_t width = nodes.size();
  Staircase staircase(nodes);
  std::size_t now = 0;
  const auto next_change = [&] {
    return now + 1 < signal.at.size() ? signal.at[now + 1] : std::numeric_limits<double>::infinity();
  };
  for (std::size_t hold = 0; hold < holds; ++hold, y += width) {
    const double begin = static_cast<double>(hold);
    while (next_change() - begin <= kClose) ++now;
    if (!(next_change() - begin < 1.0 - kClose)) {  // most holds of a slow clock
      std::fill_n(y, width, signal.value[now]);
      if (jumps != nullptr) jumps = std::fill_n(jumps, width, 0.0);
      continue;
    }
    std::size_t node = 0;
    if (jumps != nullptr) staircase.clear();
    while (true) {
      const double change = next_change() - begin;
      const bool inside = change < 1.0 - kClose;
      const double to = inside ? change : 1.0;
      while (node < width && (nodes.at[node] < to || !inside)) y[node++] = signal.value[now];
      if (jumps != nullptr) staircase.add(to, signal.value[now]);
      if (!inside) break;
      ++now;
    }
    if (jumps != nullptr) {
      std::copy_n(y, width, jumps);
      staircase.nodes(y);
      for (std::size_t j = 0; j < width; ++j) jumps[j] -= y[j];
      jumps += width;
    }
  }
}

}  // namespace bodesmith::simulate
