// The search for what is missing, whole catalogue, two threads: two records (one fitted, one held out) of 10
// 000 and of 50 000 samples each. Seconds; the counters say how many terms were named and how far the gap
// closed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "chain/registry.hpp"
#include "gap/runner.hpp"
#include "gap/search.hpp"
#include "gap/study.hpp"

namespace {

using namespace bodesmith;
constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kStep = 1e-4;

/// A multisine of four periods, or noise of the same band.
std::vector<double> input(std::size_t n, bool periodic, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<double> u(n);
  if (periodic) {
    const std::size_t rows = n / 4;
    const int top = static_cast<int>(300.0 * kStep * static_cast<double>(rows));
    for (int k = 1; k <= top; k += 2 * std::max(1, top / 100)) {
      const double phase = kTwoPi * std::uniform_real_distribution<double>()(random);
      for (std::size_t i = 0; i < rows; ++i)
        u[i] += std::sin(kTwoPi * k * static_cast<double>(i) / static_cast<double>(rows) + phase);
    }
    for (std::size_t i = rows; i < n; ++i) u[i] = u[i - rows];
  } else {
    double x = 0.0, y = 0.0;
    for (double& v : u) {
      x += 0.09 * (normal(random) - x);
      v = y += 0.09 * (x - y);
    }
  }
  double peak = 0.0;
  for (double v : u) peak = std::max(peak, std::abs(v));
  for (double& v : u) v /= peak;
  return u;
}

/// A record to be answered: train.csv (periodic) or holdout.csv.
TimeRecord unanswered(std::size_t n, bool periodic, std::mt19937_64& random) {
  TimeRecord r;
  r.file = periodic ? "train.csv" : "holdout.csv";
  r.step_s = kStep;
  r.u = input(n, periodic, random);
  return r;
}

/// y'' + 2 d w y' + w^2 (y + c y^3) = w^2 u, 260 Hz, by Runge-Kutta, eight steps a sample; noise of a fifth
/// of what the cube changes, roughly.
TimeRecord spring(std::size_t n, bool periodic, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 0.01);
  TimeRecord r = unanswered(n, periodic, random);
  const double w = kTwoPi * 260.0, d = 0.12, c = 0.2, h = kStep / 8.0;
  const auto f = [&](double u, double y, double v) {
    return w * w * (u - y * (1.0 + c * y * y)) - 2 * d * w * v;
  };
  double y = 0.0, v = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    r.y.push_back(y + normal(random));
    if (i + 1 == n) break;
    for (int k = 0; k < 8; ++k) {
      const double a = r.u[i] + (r.u[i + 1] - r.u[i]) * k / 8.0;
      const double b = r.u[i] + (r.u[i + 1] - r.u[i]) * (k + 1) / 8.0;
      const double m = 0.5 * (a + b);
      const double k1 = v, l1 = f(a, y, v);
      const double k2 = v + 0.5 * h * l1, l2 = f(m, y + 0.5 * h * k1, k2);
      const double k3 = v + 0.5 * h * l2, l3 = f(m, y + 0.5 * h * k2, k3);
      const double k4 = v + h * l3, l4 = f(b, y + h * k3, k4);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      v += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
    }
  }
  return r;
}

/// A gain whose output is cut off above 0.7.
TimeRecord clipped(std::size_t n, bool periodic, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 0.005);
  TimeRecord r = unanswered(n, periodic, random);
  for (const double u : r.u) r.y.push_back(std::min(2.0 * u, 1.4) + normal(random));
  return r;
}

void run(benchmark::State& state, const chain::Chain& base, TimeRecord (*make)(std::size_t, bool, unsigned)) {
  const auto rows = static_cast<std::size_t>(state.range(0));
  const auto study = gap::Study::of({make(rows, true, 1)}, {make(rows, false, 2)}, base);
  gap::SearchOptions options;
  options.threads = 2;
  for (auto _ : state) {
    const auto result = gap::search(base, study.train(), options);
    state.counters["terms"] = static_cast<double>(result.steps.size());
    state.counters["left"] =
        gap::rms_of(result.final, study.holdout()) / gap::rms_of(result.base, study.holdout());
  }
}

void resonator_with_cubic_spring(benchmark::State& state) {
  auto block = chain::make_block("resonator");
  block.set("gain", 1.03).set("natural_frequency_hz", 265.0).set("damping_ratio", 0.13);
  for (const char* key : {"gain", "natural_frequency_hz", "damping_ratio"}) block.free(key);
  run(state, {{block}}, spring);
}
BENCHMARK(resonator_with_cubic_spring)
    ->Arg(10000)
    ->Arg(50000)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

void gain_with_saturation(benchmark::State& state) {
  auto block = chain::make_block("gain");
  block.set("gain", 1.9);
  block.free("gain");
  run(state, {{block}}, clipped);
}
BENCHMARK(gain_with_saturation)
    ->Arg(10000)
    ->Arg(50000)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
