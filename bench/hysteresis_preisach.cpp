// Preisach plane of L = 200 levels (20100 relays) on an amplitude-modulated triangle: all relays by brute
// force, the stack of extremes with the Everett table, the exact inverse, and the identification from 20 000
// samples.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <vector>

#include "../tests/hysteresis/brute_force.hpp"
#include "hysteresis/identification/preisach_identify.hpp"
#include "hysteresis/model_type.hpp"
#include "hysteresis/preisach.hpp"
#include "hysteresis_inputs.hpp"

namespace {

using namespace bodesmith::hysteresis;

constexpr std::size_t kLevels = 200;

Model model(const char* interpolation) {
  Parameters values;
  values.set("u_min", 0.0)
      .set("u_max", 1.0)
      .set("w", relay_weights(kLevels))
      .set("interpolation", interpolation);
  return make_model("preisach", values);
}

void forward(benchmark::State& state, const char* interpolation) {
  const std::vector<double> u = modulated_triangle(100000);
  const auto op = make_operator(model(interpolation));
  op->reset(u[0]);
  for (auto _ : state) {
    double sum = 0.0;
    for (const double value : u) sum += op->step(value, 1.0);
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(u.size()));
  state.counters["ns_a_sample"] =
      benchmark::Counter(static_cast<double>(u.size()) * 1e-9,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(forward, stack_bilinear, "bilinear");
BENCHMARK_CAPTURE(forward, stack_relays, "relays");

/// The fairest brute force we know: one pass over flat arrays, wide registers where the processor has them.
__attribute__((target_clones("avx512f", "avx2", "default"))) double all_relays(const double* __restrict up,
                                                                               const double* __restrict down,
                                                                               const double* __restrict w,
                                                                               double* __restrict relay,
                                                                               std::size_t n, double x) {
  double sums[16] = {};
  for (std::size_t k = 0; k + 16 <= n; k += 16) {
    for (std::size_t l = 0; l < 16; ++l) {
      double s = relay[k + l];
      s = x >= up[k + l] ? 1.0 : s;
      s = x <= down[k + l] ? 0.0 : s;
      relay[k + l] = s;
      sums[l] += w[k + l] * s;
    }
  }
  double sum = 0.0;
  for (const double part : sums) sum += part;
  return sum;
}

void brute_force_simd(benchmark::State& state) {
  const std::vector<double> u = modulated_triangle(2000);
  std::vector<double> up, down, w = relay_weights(kLevels);
  for (std::size_t i = 0; i < kLevels; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      up.push_back(static_cast<double>(i + 1));
      down.push_back(static_cast<double>(j));
    }
  }
  while (w.size() % 16 != 0) {
    w.push_back(0.0);
    up.push_back(1e9);
    down.push_back(-1e9);
  }
  std::vector<double> relay(w.size(), 0.0);
  const auto stack = make_operator(model("relays"));
  double worst = std::abs(stack->reset(u[0]) -
                          all_relays(up.data(), down.data(), w.data(), relay.data(), w.size(), 200.0 * u[0]));
  for (const double value : u)
    worst = std::max(
        worst, std::abs(stack->step(value, 1.0) -
                        all_relays(up.data(), down.data(), w.data(), relay.data(), w.size(), 200.0 * value)));
  for (auto _ : state) {
    double sum = 0.0;
    for (const double value : u)
      sum += all_relays(up.data(), down.data(), w.data(), relay.data(), w.size(), 200.0 * value);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["ns_a_sample"] =
      benchmark::Counter(static_cast<double>(u.size()) * 1e-9,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["worst_against_stack"] = worst;
}
BENCHMARK(brute_force_simd);

void brute_force(benchmark::State& state) {
  const std::vector<double> u = modulated_triangle(2000);
  testing::BruteForceRelays all(0.0, 1.0, kLevels, relay_weights(kLevels), 0.0);
  all.reset(u[0]);
  for (auto _ : state) {
    double sum = 0.0;
    for (const double value : u) sum += all.step(value);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["ns_a_sample"] =
      benchmark::Counter(static_cast<double>(u.size()) * 1e-9,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(brute_force);

void inverse(benchmark::State& state) {
  const std::vector<double> u = modulated_triangle(100000);
  const auto op = make_operator(model("bilinear"));
  const auto inv = make_inverse(model("bilinear"));
  op->reset(0.0);
  const double top = op->step(1.0, 1.0);
  std::vector<double> wanted;
  for (const double value : u) wanted.push_back(top * value);
  double worst = 0.0;
  op->reset(inv->reset(wanted[0]));
  for (const double y : wanted) worst = std::max(worst, std::abs(op->step(inv->step(y, 1.0), 1.0) - y));
  for (auto _ : state) {
    double sum = 0.0;
    for (const double y : wanted) sum += inv->step(y, 1.0);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["ns_a_sample"] =
      benchmark::Counter(static_cast<double>(wanted.size()) * 1e-9,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["worst_H_of_inverse_minus_y"] = worst;
}
BENCHMARK(inverse);

void identification(benchmark::State& state) {
  bodesmith::TimeRecord record;
  record.step_s = 1e-3;
  record.u = modulated_triangle(20000);
  const auto op = make_operator(model("bilinear"));
  for (std::size_t i = 0; i < record.u.size(); ++i)
    record.y.push_back((i == 0 ? op->reset(record.u[0]) : op->step(record.u[i], 1.0)) +
                       1e-3 * std::sin(1e4 * static_cast<double>(i * i % 1009)));
  PreisachWeights fit;
  for (auto _ : state) fit = fit_preisach_weights({&record, 1}, 0.0, 0.0, 1.0, kLevels, CellShape::bilinear);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["rms"] = fit.rms;
  state.counters["kkt"] = fit.kkt;
  state.counters["iterations"] = fit.iterations;
  state.counters["process_peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
}
BENCHMARK(identification)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
