// 1e5 frequencies of a sixteen-pole chain.
#include <benchmark/benchmark.h>

#include <cmath>

#include "lti/bulk_response.hpp"

namespace {

using namespace bodesmith;

Sections sixteen() {
  Sections s;
  for (int i = 0; i < 16; ++i) {
    const double w = 20.0 * std::pow(1.3, i);
    s.sections.push_back(Section::pole_zero(1.0, {w}, {i % 2 == 0 ? 1.2 * w : w / 1.2}));
  }
  return s;
}

std::vector<RadPerSecond> grid() {
  std::vector<RadPerSecond> w;
  for (int i = 0; i < 100000; ++i) w.push_back({std::pow(10.0, 6.0 * i / 100000)});
  return w;
}

void magnitudes(benchmark::State& state) {
  const BulkResponse bulk(sixteen());
  const auto w = grid();
  std::vector<double> out(w.size());
  for (auto _ : state) {
    bulk.magnitudes(w, out);
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(magnitudes)->Unit(benchmark::kMillisecond);

void responses(benchmark::State& state) {
  const BulkResponse bulk(sixteen());
  const auto w = grid();
  std::vector<std::complex<double>> out(w.size());
  for (auto _ : state) {
    bulk.responses(w, out);
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(responses)->Unit(benchmark::kMillisecond);

void one_by_one(benchmark::State& state) {
  const Sections s = sixteen();
  const auto w = grid();
  std::vector<std::complex<double>> out(w.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < w.size(); ++i) out[i] = s.response(w[i]);
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(one_by_one)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
