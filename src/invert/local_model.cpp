#include "invert/local_model.hpp"

#include <algorithm>
#include <cmath>

#include "chain/inverse.hpp"
#include "chain/kernel.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::invert {
namespace {

using chain::Kernel;
using chain::LinearKernel;
using chain::SampledSystem;

double range_of(const std::vector<double>& v) {
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  return *high - *low;
}

/// dy/du from sample to sample, held near its median: at a turn an operator may stand still or jump, and a change
/// there says nothing.
std::vector<double> secant_slopes(const std::vector<double>& u, const std::vector<double>& y) {
  const double least = 1e-6 * range_of(u);
  const double whole = range_of(u) > 0.0 ? range_of(y) / range_of(u) : 1.0;
  std::vector<double> slopes(u.size(), 0.0);
  std::vector<double> seen;
  for (std::size_t i = 1; i < u.size(); ++i) {
    const double move = u[i] - u[i - 1];
    const bool moves = std::abs(move) > least && least > 0.0;
    slopes[i] = moves ? (y[i] - y[i - 1]) / move : slopes[i - 1];
    if (moves) seen.push_back(slopes[i]);
  }
  double middle = seen.empty() ? whole : median(seen);
  if (std::abs(middle) < 0.05 * whole) middle = whole;
  if (middle == 0.0) middle = 1.0;
  slopes.front() = middle;
  const auto [low, high] = std::minmax({0.2 * middle, 5.0 * middle});
  for (double& slope : slopes) slope = std::clamp(slope, low, high);
  return slopes;
}

/// The system of smooth dynamics at every sample, its states followed by the classical Runge-Kutta method.
std::vector<SampledSystem> tangents(const chain::OdeKernel& kernel, const std::vector<double>& u,
                                    double step_s) {
  const StateSpace& linear = kernel.linear();
  const std::size_t n = linear.order();
  const double parts = std::clamp(std::ceil(2.0 * step_s * max_row_sum(linear)), 1.0, 200.0);
  const double h = step_s / parts;
  std::vector<double> x(n);
  kernel.equilibrium(u[0], x.data());
  const auto rate = [&](const std::vector<double>& at, double in, std::vector<double>& dx) {
    derivative(linear, in, at.data(), dx.data());
    const double force = kernel.nonlinear(at.data(), in);
    for (std::size_t i = 0; i < n; ++i) dx[i] += kernel.entry()[i] * force;
  };
  std::vector<std::vector<double>> k(4, std::vector<double>(n));
  std::vector<double> probe(n);
  std::vector<double> by_x(n);
  std::vector<SampledSystem> out;
  for (std::size_t s = 0; s + 1 < u.size(); ++s) {
    StateSpace tangent = linear;
    const double by_u = kernel.nonlinear_gradient(x.data(), u[s], by_x.data());
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) tangent.a[i * n + j] += kernel.entry()[i] * by_x[j];
      tangent.b[i] += kernel.entry()[i] * by_u;
    }
    out.push_back(chain::sampled(tangent, step_s));
    for (double part = 0.0; part < parts; part += 1.0) {
      const auto input = [&](double place) { return u[s] + (u[s + 1] - u[s]) * (part + place) / parts; };
      const double weight[4] = {0.0, 0.5, 0.5, 1.0};
      for (std::size_t stage = 0; stage < 4; ++stage) {
        for (std::size_t i = 0; i < n; ++i)
          probe[i] = x[i] + (stage == 0 ? 0.0 : h * weight[stage] * k[stage - 1][i]);
        rate(probe, input(weight[stage]), k[stage]);
      }
      for (std::size_t i = 0; i < n; ++i) x[i] += h / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
    }
    if (std::ranges::any_of(x, [](double v) { return !(std::abs(v) < 1e30); })) x.assign(n, 0.0);
  }
  return out;
}

/// Adds one block after the other to a local model.
class Builder {
 public:
  Builder(LocalModel& model, double step_s) : model_(model), step_s_(step_s) {}

  void add(Kernel& kernel, const std::vector<double>& in, const std::vector<double>& out) {
    in_ = &in;
    out_ = &out;
    std::visit([&](auto& one) { add_kernel(one); }, kernel);
  }

 private:
  void add_kernel(LinearKernel& kernel) {
    model_.delay_s += kernel.delay_s;
    if (kernel.order() == 0) return add_slopes({kernel.d});
    model_.gain *= chain::slowest_gain(kernel, step_s_, in_->size());
    model_.chain.add(chain::sampled(kernel, step_s_));
  }
  void add_kernel(std::unique_ptr<chain::CurveKernel>& curve) {
    std::vector<double> slopes;
    for (const double u : *in_) slopes.push_back(curve->slope(u));
    add_slopes(std::move(slopes));
  }
  void add_kernel(std::unique_ptr<chain::SourceKernel>&) {}
  void add_kernel(std::unique_ptr<chain::OdeKernel>& system) {
    model_.gain *= range_of(*in_) > 0.0 ? std::max(range_of(*out_) / range_of(*in_), 1e-300) : 1.0;
    model_.chain.add(moved_up(tangents(*system, *in_, step_s_)));
  }
  void add_kernel(std::unique_ptr<chain::MemoryKernel>&) { add_slopes(secant_slopes(*in_, *out_)); }
  void add_kernel(std::unique_ptr<chain::SampledKernel>& kernel) {
    model_.delay_s += chain::mean_delay_s(*kernel);
    add_slopes({chain::gain_at_rest(*kernel)});
  }

  void add_slopes(std::vector<double> slopes) {
    const double size = rms(slopes);
    model_.gain *= size > 0.0 ? size : 1.0;
    model_.chain.add(moved_up(std::move(slopes)));
  }
  /// What a block behind delays is later, the chain without them is now.
  template <class T>
  std::vector<T> moved_up(std::vector<T> list) const {
    const std::size_t size = list.size();
    const T last = list.back();
    const double by = std::min(std::round(model_.delay_s / step_s_), static_cast<double>(size));
    list.erase(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(by));
    list.resize(size, last);
    return list;
  }

  LocalModel& model_;
  double step_s_;
  const std::vector<double>* in_ = nullptr;
  const std::vector<double>* out_ = nullptr;
};

}  // namespace

LocalModel local_model(std::vector<Kernel>& blocks, const std::vector<std::vector<double>>& signals,
                       double step_s) {
  LocalModel out{chain::LocalChain(step_s, signals[0].size()), 0.0, 1.0};
  Builder builder(out, step_s);
  for (std::size_t i = 0; i < blocks.size(); ++i) builder.add(blocks[i], signals[i], signals[i + 1]);
  return out;
}

double total_delay_s(const std::vector<Kernel>& blocks) {
  double out = 0.0;
  for (const Kernel& kernel : blocks) {
    if (const auto* linear = std::get_if<LinearKernel>(&kernel)) out += linear->delay_s;
    if (const auto* clocked = std::get_if<std::unique_ptr<chain::SampledKernel>>(&kernel))
      out += chain::mean_delay_s(**clocked);
  }
  return out;
}

}  // namespace bodesmith::invert
