// 1e5 frequencies of a sixteen-pole chain; and what `bode` makes of eight poles: level and unwrapped phase, beside
// the same with std::complex, one frequency at a time.
#include <benchmark/benchmark.h>

#include <cmath>

#include "lti/bulk_response.hpp"
#include "lti/frequency_grid.hpp"

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

Sections eight() {
  Sections s = sixteen();
  s.sections.resize(8);
  return s;
}

void bode_table(benchmark::State& state) {
  const Sections s = eight();
  const std::vector<Hertz> f = log_grid({Hertz{0.1}, Hertz{1e5}}, 100000);
  for (auto _ : state) {
    const LevelAndPhase curves = level_and_phase(s, f);
    benchmark::DoNotOptimize(curves.phase_deg.data());
  }
}
BENCHMARK(bode_table)->Unit(benchmark::kMillisecond);

void peer_complex(benchmark::State& state) {
  const Sections s = eight();
  const std::vector<Hertz> f = log_grid({Hertz{0.1}, Hertz{1e5}}, 100000);
  std::vector<double> level(f.size()), phase(f.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < f.size(); ++i) {
      const std::complex<double> jw(0.0, f[i].rad_s().value);
      std::complex<double> h = s.gain;
      for (const Section& section : s.sections) {
        h *= section.gain;
        for (const auto& z : section.zeros) h *= jw - z;
        for (const auto& p : section.poles) h /= jw - p;
      }
      level[i] = 20.0 * std::log10(std::abs(h));
      phase[i] = std::arg(h) * 180.0 / M_PI;
      if (i > 0) phase[i] += 360.0 * std::round((phase[i - 1] - phase[i]) / 360.0);
    }
    benchmark::DoNotOptimize(phase.data());
  }
}
BENCHMARK(peer_complex)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
