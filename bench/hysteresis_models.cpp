// Forward and inverse of every model on one amplitude-modulated triangle, nanoseconds a sample; KP also by
// every kernel.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "../tests/hysteresis/brute_force.hpp"
#include "hysteresis/krasnoselskii_pokrovskii.hpp"
#include "hysteresis/model_type.hpp"
#include "hysteresis_inputs.hpp"

namespace {

using namespace bodesmith::hysteresis;

Model bank(std::size_t plays) {
  std::vector<double> r, w;
  for (std::size_t i = 0; i < plays; ++i) {
    r.push_back(0.5 * static_cast<double>(i) / static_cast<double>(plays));
    w.push_back(i == 0 ? 0.6 : 0.4 / static_cast<double>(plays));
  }
  return make_model("prandtl_ishlinskii", Parameters().set("r", r).set("w", w));
}

Model kp() {
  return make_model("krasnoselskii_pokrovskii",
                    Parameters().set("u_min", 0.0).set("u_max", 1.0).set("mu", relay_weights(200)));
}

benchmark::Counter a_sample(std::size_t n) {
  return {static_cast<double>(n) * 1e-9,
          benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

void forward(benchmark::State& state, const Model& model) {
  const std::vector<double> u = modulated_triangle(20000);
  const auto op = make_operator(model);
  op->reset(u[0]);
  for (auto _ : state) {
    double sum = 0.0;
    for (const double value : u) sum += op->step(value, 1e-4);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["ns_a_sample"] = a_sample(u.size());
}

void inverse(benchmark::State& state, const Model& model) {
  const std::vector<double> u = modulated_triangle(20000);
  const auto op = make_operator(model);
  const auto inv = make_inverse(model);
  std::vector<double> wanted{op->reset(u[0])};
  for (std::size_t i = 1; i < u.size(); ++i) wanted.push_back(op->step(u[i], 1e-4));
  double worst = 0.0;
  op->reset(inv->reset(wanted[0]));
  for (const double y : wanted) worst = std::max(worst, std::abs(op->step(inv->step(y, 1e-4), 1e-4) - y));
  for (auto _ : state) {
    double sum = 0.0;
    for (const double y : wanted) sum += inv->step(y, 1e-4);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["ns_a_sample"] = a_sample(wanted.size());
  state.counters["worst_H_of_inverse_minus_y"] = worst;
}

void kp_every_kernel(benchmark::State& state) {
  const std::vector<double> u = modulated_triangle(500);
  testing::BruteForceKp all(0.0, 1.0, 200, relay_weights(200));
  all.reset(u[0]);
  for (auto _ : state) {
    double sum = 0.0;
    for (const double value : u) sum += all.step(value);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["ns_a_sample"] = a_sample(u.size());
}

void kp_recursive(benchmark::State& state) {
  const std::vector<double> u = modulated_triangle(2000);
  RecursiveInverse inv(make_operator(kp()), 1e-4, 0.0, 1.0);
  const auto op = make_operator(kp());
  std::vector<double> wanted{op->reset(u[0])};
  for (std::size_t i = 1; i < u.size(); ++i) wanted.push_back(op->step(u[i], 1e-4));
  inv.reset(wanted[0]);
  for (auto _ : state) {
    double sum = 0.0;
    for (const double y : wanted) sum += inv.step(y, 1e-4);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["ns_a_sample"] = a_sample(wanted.size());
}

BENCHMARK_CAPTURE(forward, kp_20100_stack, kp());
BENCHMARK(kp_every_kernel);
BENCHMARK_CAPTURE(inverse, kp_20100_exact, kp());
BENCHMARK(kp_recursive);
BENCHMARK_CAPTURE(forward, prandtl_ishlinskii_8, bank(8));
BENCHMARK_CAPTURE(forward, prandtl_ishlinskii_256, bank(256));
BENCHMARK_CAPTURE(inverse, prandtl_ishlinskii_8, bank(8));
BENCHMARK_CAPTURE(inverse, prandtl_ishlinskii_256, bank(256));
BENCHMARK_CAPTURE(forward, exponential_4,
                  make_model("exponential_operator",
                             Parameters().set("k", {0.5, 0.2, 0.1, 0.2}).set("tau", {80.0, 20.0, 5.0, 1.0})));
BENCHMARK_CAPTURE(inverse, exponential_4,
                  make_model("exponential_operator",
                             Parameters().set("k", {0.5, 0.2, 0.1, 0.2}).set("tau", {80.0, 20.0, 5.0, 1.0})));
BENCHMARK_CAPTURE(forward, polynomial_nested,
                  make_model("polynomial_hysteresis", Parameters()
                                                          .set("ascending", {-0.3546, 0.6433, -0.2887})
                                                          .set("descending", {0.2398, -0.0838, -0.156})
                                                          .set("minor", "nested")));
BENCHMARK_CAPTURE(forward, bouc_wen,
                  make_model("bouc_wen",
                             Parameters().set("k", 2.0).set("A", 0.5).set("beta", 3.0).set("gamma", 1.0)));
BENCHMARK_CAPTURE(forward, fractional_60_sections,
                  make_model("fractional_dynamic", Parameters()
                                                       .set("K_M", 1.71e8)
                                                       .set("xi", 0.031)
                                                       .set("omega_n", 1.28e4)
                                                       .set("tau", 4.18e-4)
                                                       .set("eta", 0.756)
                                                       .set("lambda", 0.811)
                                                       .set("K_p", 0.192)
                                                       .set("Theta", 5.923)
                                                       .set("chi", 6.897)));

}  // namespace

BENCHMARK_MAIN();
