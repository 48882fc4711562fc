// Time of one term's approximation, and of the smallest order search of the disturbance paper's cascade.
#include <benchmark/benchmark.h>

#include "approximate/approximate.hpp"

namespace {

using namespace bodesmith;

void term(benchmark::State& state) {
  const double kappa = static_cast<double>(state.range(0));
  const double beta = static_cast<double>(state.range(1)) / 100.0;
  const int order = static_cast<int>(state.range(2));
  const FractionalLeadLag lead{1.0, 1.0 / kappa, beta};
  double db = 0.0;
  for (auto _ : state) {
    const TermApproximation made = value_or_throw(try_approximate_term(lead, {}, order));
    db = made.error.everywhere_db;
  }
  state.counters["dB"] = db;
}
BENCHMARK(term)
    ->ArgsProduct({{2, 10, 1000, 1000000}, {50, 190}, {2, 4, 8, 12}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(term)->Args({10, 250, 6})->Args({10, 990, 12})->Unit(benchmark::kMillisecond);

void whole_cascade(benchmark::State& state) {
  Cascade cascade;
  const double corner[] = {1, 10, 20, 60, 100};
  const double beta[] = {-0.0428, 1.0245, -1.2113, 2.2908};
  for (int i = 0; i < 4; ++i) {
    cascade.terms.push_back({1.0 / Hertz{corner[i]}.rad_s().value, corner[i] / corner[i + 1], beta[i]});
  }
  ApproximationOptions options;
  options.max_error_db = 0.01;
  for (auto _ : state) benchmark::DoNotOptimize(approximate_cascade(cascade, options).sections.gain);
}
BENCHMARK(whole_cascade)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
