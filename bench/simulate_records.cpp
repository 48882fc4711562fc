// A million samples through eight first-order sections: computing alone, and the table around it. Peers: the same chain
// as one matrix of order eight, discretised and stepped with Eigen; the table with strtod and printf.
#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "chain/kernel.hpp"
#include "chain/registry.hpp"
#include "signal/csv.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace bodesmith;
constexpr std::size_t kSamples = 1'000'000;
constexpr double kCorners[] = {30, 80, 200, 500, 1200, 3000, 7000, 15000};

chain::Chain sections(bool equal) {
  chain::Chain out;
  for (const double f : kCorners)
    out.blocks.push_back(chain::make_block("pole_zero")
                             .set("gain", 1.0)
                             .set("zero_hz", 1.3 * (equal ? 500.0 : f))
                             .set("pole_hz", equal ? 500.0 : f));
  return out;
}

const TimeRecord& noise() {
  static const TimeRecord record = [] {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> value(-1.0, 1.0);
    TimeRecord out;
    out.step_s = 1e-5;
    for (std::size_t i = 0; i < kSamples; ++i) out.u.push_back(value(random));
    return out;
  }();
  return record;
}

void by_modes(benchmark::State& state) {
  const chain::Chain chain = sections(false);
  for (auto _ : state) benchmark::DoNotOptimize(simulate::simulate(chain, noise(), {}).y.data());
}
BENCHMARK(by_modes)->Unit(benchmark::kMillisecond);

void equal_poles(benchmark::State& state) {
  const chain::Chain chain = sections(true);
  for (auto _ : state) benchmark::DoNotOptimize(simulate::simulate(chain, noise(), {}).y.data());
}
BENCHMARK(equal_poles)->Unit(benchmark::kMillisecond);

/// x' = A x + b u over straight lines: [x; u; slope] stepped by one exponential.
void peer_matrix(benchmark::State& state) {
  chain::LinearKernel k = chain::gain_kernel(1.0);
  for (const auto& block : sections(false).blocks)
    k = chain::in_series(k, std::get<chain::LinearKernel>(block.kernel()));
  using Matrix8 = Eigen::Matrix<double, 8, 8>;
  using Vector8 = Eigen::Matrix<double, 8, 1>;
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(10, 10);
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) m(i, j) = k.a[static_cast<std::size_t>(8 * i + j)] * 1e-5;
    m(i, 8) = k.b[static_cast<std::size_t>(i)] * 1e-5;
  }
  m(8, 9) = 1.0;
  const Eigen::MatrixXd e = m.exp();
  const Matrix8 a = e.topLeftCorner(8, 8);
  const Vector8 b0 = e.block(0, 8, 8, 1), b1 = e.block(0, 9, 8, 1);
  const Vector8 c = Eigen::Map<const Vector8>(k.c.data());
  std::vector<double> y(kSamples);
  for (auto _ : state) {
    Vector8 x = Vector8::Zero();
    const std::vector<double>& u = noise().u;
    for (std::size_t i = 0; i + 1 < kSamples; ++i) {
      y[i] = c.dot(x) + k.d * u[i];
      const Vector8 next = a * x + b0 * u[i] + b1 * (u[i + 1] - u[i]);
      x = next;
    }
    y[kSamples - 1] = c.dot(x) + k.d * u[kSamples - 1];
    benchmark::DoNotOptimize(y.data());
  }
}
BENCHMARK(peer_matrix)->Unit(benchmark::kMillisecond);

std::string table() {
  CsvWriter csv;
  std::vector<double> time(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) time[i] = noise().time_s(i);
  csv.add("time_s", time);
  csv.add("u", noise().u);
  return csv.text();
}

void write_table(benchmark::State& state) {
  CsvWriter csv;
  csv.add("u", noise().u);
  csv.add("y", noise().u);
  for (auto _ : state) benchmark::DoNotOptimize(csv.text().data());
}
BENCHMARK(write_table)->Unit(benchmark::kMillisecond);

void peer_printf(benchmark::State& state) {
  for (auto _ : state) {
    std::string out;
    char line[64];
    for (const double u : noise().u)
      out.append(line, static_cast<std::size_t>(std::snprintf(line, sizeof line, "%.17g,%.17g\n", u, u)));
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(peer_printf)->Unit(benchmark::kMillisecond);

void read_table(benchmark::State& state) {
  const std::string text = table();
  for (auto _ : state) {
    const Csv csv = Csv::parse(text, "u.csv");
    benchmark::DoNotOptimize(csv.column("u").data());
  }
}
BENCHMARK(read_table)->Unit(benchmark::kMillisecond);

void peer_strtod(benchmark::State& state) {
  const std::string text = table();
  for (auto _ : state) {
    std::vector<double> values;
    const char* p = text.c_str() + text.find('\n');
    while (*p != '\0') {
      char* end = nullptr;
      const double value = std::strtod(p, &end);
      if (end == p) break;
      values.push_back(value);
      p = *end == '\0' ? end : end + 1;
    }
    benchmark::DoNotOptimize(values.data());
  }
}
BENCHMARK(peer_strtod)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
