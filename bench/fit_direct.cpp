// Time of direct and waveform fits.
#include <benchmark/benchmark.h>

#include <cmath>

#include "fit/direct/direct_fit.hpp"
#include "fit/waveform/waveform_fit.hpp"

namespace {

using namespace bodesmith;

void pink_noise(benchmark::State& state) {
  BodePoints points;
  for (const Hertz f : log_grid({Hertz{20.0}, Hertz{20000.0}}, 200)) {
    points.points.push_back({f, 1.0 / std::sqrt(f.value), std::nullopt, 1.0, 0});
  }
  DirectFitOptions options;
  options.order = static_cast<int>(state.range(0));
  double db = 0.0;
  for (auto _ : state) db = fit_directly(points, options).max_db;
  state.counters["dB"] = db;
}
BENCHMARK(pink_noise)->Arg(4)->Arg(6)->Arg(8)->Unit(benchmark::kMillisecond);

void waveform(benchmark::State& state) {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  for (const double f : {1.0, 10.0, 20.0, 60.0, 100.0}) d.rate.frequency.push_back(Hertz{f});
  d.rate.ascending = d.rate.descending = {1, 1.06, 1.1, 1.04, 1.17};
  WaveformFitOptions options;
  options.order = static_cast<int>(state.range(0));
  options.worst = state.range(1) != 0;
  double percent = 0.0;
  for (auto _ : state) {
    const WaveformError error = fit_waveform(d, options).error;
    percent = options.worst ? error.worst_percent : error.rms_percent;
  }
  state.counters["percent"] = percent;
}
BENCHMARK(waveform)->ArgsProduct({{1, 2, 4}, {0, 1}})->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
