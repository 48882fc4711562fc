#include "simulate/feedback_exact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "chain/linear_kernel.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {
namespace {

using chain::LinearKernel;

/// x' = A x + sum_q b_q v_q + constant over one step, each v_q a straight line.
class Stepper {
 public:
  Stepper(const StateSpace& system, const std::vector<const double*>& inputs, double step_s)
      : next_(system.order()) {
    HoldResponseSolver().solve(system, inputs, step_s, hold_nodes(1), 1.0, response_);
  }

  /// v: begin and end of each input.
  void step(std::vector<double>& x, std::initializer_list<std::pair<double, double>> v) {
    const std::size_t n = next_.size();
    for (std::size_t i = 0; i < n; ++i) {
      double sum = response_.k[i];
      const double* e = response_.e.data() + i * n;
      for (std::size_t j = 0; j < n; ++j) sum += e[j] * x[j];
      std::size_t q = 0;
      for (const auto& [begin, end] : v) {
        sum += response_.g[q][2 * i] * begin + response_.g[q][2 * i + 1] * end;
        ++q;
      }
      next_[i] = sum;
    }
    std::swap(x, next_);
  }

 private:
  HoldResponse response_;
  std::vector<double> next_;
};

double output_of(const StateSpace& plant, const std::vector<double>& x) {
  double y = plant.offset;
  for (std::size_t i = 0; i < plant.c.size(); ++i) y += plant.c[i] * x[i];
  return y;
}

/// begin + (end - begin) i/count.
double between(double begin, double end, int i, int count) {
  return i == count ? end : begin + (end - begin) * i / count;
}

void run_continuous(const StateSpace& plant, const std::vector<double>& f, const PidController& c,
                    const TimeRecord& r, int parts, std::vector<double> state, LoopResult& out) {
  const auto n = plant.order();
  const std::size_t size = n + 2;
  const double wd = c.derivative_s == 0.0 ? 0.0 : c.derivative_corner.rad_s().value;
  const double direct = c.proportional + c.derivative_s * wd;
  StateSpace closed;
  closed.b.assign(size, 0.0);
  closed.a.assign(size * size, 0.0);
  closed.constant.assign(size, 0.0);
  std::vector<double> by_f(size, 0.0);
  std::vector<double> by_r(size, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    double* row = closed.a.data() + i * size;
    for (std::size_t j = 0; j < n; ++j) row[j] = plant.a[i * n + j] - plant.b[i] * direct * plant.c[j];
    row[n] = plant.b[i];
    row[n + 1] = -plant.b[i] * c.derivative_s * wd;
    by_f[i] = plant.b[i];
    by_r[i] = plant.b[i] * direct;
    if (!plant.constant.empty()) closed.constant[i] = plant.constant[i];
    closed.a[n * size + i] = -c.integral_per_s * plant.c[i];
    closed.a[(n + 1) * size + i] = -wd * plant.c[i];
  }
  closed.a[(n + 1) * size + n + 1] = -wd;
  by_r[n] = c.integral_per_s;
  by_r[n + 1] = wd;
  for (std::size_t i = 0; i < size; ++i) closed.constant[i] -= by_r[i] * plant.offset;

  Stepper stepper(closed, {by_f.data(), by_r.data()}, r.step_s / parts);
  state.resize(size, 0.0);
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (i % 65536 == 0) stop_if_interrupted();
    for (int part = 0; i > 0 && part < parts; ++part) {
      stepper.step(
          state, {{between(f[i - 1], f[i], part, parts), between(f[i - 1], f[i], part + 1, parts)},
                  {between(r.u[i - 1], r.u[i], part, parts), between(r.u[i - 1], r.u[i], part + 1, parts)}});
    }
    const double y = output_of(plant, state);
    const double error = r.u[i] - y;
    out.y.push_back(y);
    out.drive.push_back(f[i] + direct * error + state[n] - c.derivative_s * wd * state[n + 1]);
  }
  out.stats.steps = (r.size() - 1) * static_cast<std::size_t>(parts);
}

/// `edges` clock edges a sample interval, or one in `interval` samples.
void run_sampled(const StateSpace& plant, const std::vector<double>& f, const PidController& c,
                 const TimeRecord& r, int edges, std::size_t interval, int parts, std::vector<double> state,
                 LoopResult& out) {
  const int pieces = edges * parts;
  Stepper stepper(plant, {plant.b.data()}, r.step_s / pieces);
  SampledPid pid(c);
  double held = pid.update(r.u[0] - output_of(plant, state));
  out.y.push_back(output_of(plant, state));
  out.drive.push_back(f[0] + held);
  for (std::size_t i = 1; i < r.size(); ++i) {
    if (i % 65536 == 0) stop_if_interrupted();
    for (int piece = 0; piece < pieces; ++piece) {
      stepper.step(state, {{held + between(f[i - 1], f[i], piece, pieces),
                            held + between(f[i - 1], f[i], piece + 1, pieces)}});
      const bool inside = piece + 1 < pieces && (piece + 1) % parts == 0;
      if (inside) held = pid.update(between(r.u[i - 1], r.u[i], piece + 1, pieces) - output_of(plant, state));
    }
    const double y = output_of(plant, state);
    // The record ends before the edge on its last sample.
    if (i % interval == 0 && i + 1 < r.size()) held = pid.update(r.u[i] - y);
    out.y.push_back(y);
    out.drive.push_back(f[i] + held);
  }
  out.stats.steps = (r.size() - 1) * static_cast<std::size_t>(pieces);
}

}  // namespace

std::optional<LoopResult> run_exact_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                                         const PidController& controller, const TimeRecord& reference,
                                         Start start, int parts, std::string& why_not) {
  const auto no = [&](std::string reason) {
    why_not = std::move(reason);
    return std::nullopt;
  };
  LoopResult out;
  out.stats.engine = "exact";
  LinearKernel linear = chain::gain_kernel(1.0);
  for (std::size_t i = 0; i < plant.blocks.size(); ++i) {
    const chain::Kernel kernel = plant.blocks[i].kernel();
    const auto* k = std::get_if<LinearKernel>(&kernel);
    if (k == nullptr || k->delay_s > 0.0) {
      return no(fmt::format("block {} ({}) is not linear dynamics", i + 1, plant.blocks[i].type_name()));
    }
    out.model_error += k->approximation_error;
    linear = chain::in_series(linear, *k);
  }
  if (linear.d != 0.0 || linear.order() == 0) return no("the plant answers its drive at once");
  int edges = 1;
  std::size_t interval = 1;
  if (controller.period_s > 0.0) {
    const double ratio = controller.period_s / reference.step_s;
    const double whole = std::round(std::max(ratio, 1.0 / ratio));
    if (std::abs(std::max(ratio, 1.0 / ratio) - whole) > 1e-9 * whole || whole > 1e6) {
      return no("the controller's period and the record's step are not whole multiples of each other");
    }
    if (ratio >= 1.0) {
      interval = static_cast<std::size_t>(whole);
    } else {
      edges = static_cast<int>(whole);
    }
  } else if (controller.limited()) {
    return no("a continuous controller with limits is not linear");
  }
  std::vector<double> state(linear.order(), 0.0);
  if (start == Start::equilibrium) equilibrium(linear, feedforward.front(), state.data());
  out.y.reserve(reference.size());
  out.drive.reserve(reference.size());
  if (controller.period_s > 0.0) {
    run_sampled(linear, feedforward, controller, reference, edges, interval, parts, std::move(state), out);
  } else {
    run_continuous(linear, feedforward, controller, reference, parts, std::move(state), out);
  }
  return out;
}

}  // namespace bodesmith::simulate
