#include "simulate/sampled_propagator.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bodesmith::simulate {
namespace {

/// Node values of the polynomial of degree p that has the same p+1 moments over [0, 1] as a staircase:
/// shifted Legendre series, whose partial integrals are closed.
class Staircase {
 public:
  explicit Staircase(const HoldNodes& nodes) : nodes_(nodes) {
    for (int j = 0; j <= nodes.degree; ++j)
      legendre(2.0 * nodes.at[static_cast<size_t>(j)] - 1.0, at_node_[static_cast<size_t>(j)]);
  }
  void clear() { std::fill(sum_, sum_ + kMaxDegree + 1, 0.0); }
  /// The staircase is `value` over [from, to].
  void add(double from, double to, double value) {
    double low[kMaxDegree + 2];
    double high[kMaxDegree + 2];
    legendre(2.0 * from - 1.0, low);
    legendre(2.0 * to - 1.0, high);
    for (int k = 0; k <= nodes_.degree; ++k) {
      // (2k+1) int P_k(2s-1) ds = [P_{k+1} - P_{k-1}]/2
      const double before_low = k == 0 ? -1.0 : low[k - 1];
      const double before_high = k == 0 ? -1.0 : high[k - 1];
      const double integral =
          k == 0 ? to - from : 0.5 * ((high[k + 1] - before_high) - (low[k + 1] - before_low));
      sum_[k] += value * integral;
    }
  }
  void nodes(double* y) const {
    for (int j = 0; j <= nodes_.degree; ++j) {
      y[j] = 0.0;
      for (int k = 0; k <= nodes_.degree; ++k) y[j] += sum_[k] * at_node_[static_cast<size_t>(j)][k];
    }
  }

 private:
  static void legendre(double x, double* p) {
    p[0] = 1.0;
    p[1] = x;
    for (int k = 1; k <= kMaxDegree; ++k) p[k + 1] = ((2 * k + 1) * x * p[k] - k * p[k - 1]) / (k + 1);
  }
  const HoldNodes& nodes_;
  double at_node_[kMaxDegree + 1][kMaxDegree + 2]{};
  double sum_[kMaxDegree + 1]{};
};

}  // namespace

void run_sampled(chain::SampledKernel& kernel, const HoldNodes& nodes, double h, const double* u, double* y,
                 std::size_t holds, bool equilibrium, bool point_values) {
  const int p = nodes.degree;
  const double cycle = 1.0 / (kernel.clock_hz() * h);  // in holds
  const double lag = kernel.delay_s() / h;
  constexpr double kClose = 1e-9;
  double held = holds > 0 ? kernel.reset(u[0], equilibrium) : 0.0;
  std::size_t sampled = 0;  // edges whose sample is taken
  std::size_t shown = 0;    // samples that have come out
  // Samples wait here for their lag; never more than lag/cycle + 2 of them.
  std::vector<double> waiting(static_cast<size_t>(lag / cycle) + 3, 0.0);
  Staircase staircase(nodes);
  for (std::size_t hold = 0; hold < holds; ++hold) {
    const double begin = static_cast<double>(hold);
    const double* v = u + hold * static_cast<size_t>(p + 1);
    double* out = y + hold * static_cast<size_t>(p + 1);
    const auto take_samples = [&](double until) {
      while (true) {
        const double when = static_cast<double>(sampled) * cycle;
        if (when > until) return;
        const double s = std::clamp(when - begin, 0.0, 1.0);
        waiting[sampled % waiting.size()] = kernel.update(nodes.value(v, s));
        ++sampled;
      }
    };
    // An edge at the end of a hold samples what is there before the next one begins, but shows in the next
    // one.
    take_samples(begin + kClose);
    const auto next_change = [&] { return static_cast<double>(shown) * cycle + lag - begin; };
    while (next_change() <= kClose) {
      held = waiting[shown % waiting.size()];
      ++shown;
    }
    int node = 0;
    double from = 0.0;
    staircase.clear();
    bool steps = false;
    while (true) {
      const double change = next_change();
      const bool inside = change < 1.0 - kClose;
      const double to = inside ? change : 1.0;
      while (node <= p && (nodes.at[static_cast<size_t>(node)] < to || !inside)) out[node++] = held;
      staircase.add(from, to, held);
      if (!inside) break;
      steps = true;
      take_samples(begin + change);
      held = waiting[shown % waiting.size()];
      ++shown;
      from = to;
    }
    if (steps && !point_values) staircase.nodes(out);
    take_samples(begin + 1.0 - kClose);
  }
}

}  // namespace bodesmith::simulate
