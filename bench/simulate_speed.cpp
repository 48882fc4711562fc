// Simulation: eight poles behind the switched cubic of the disturbance paper, 100 Hz triangle, 1 s, by every engine
// and by ngspice on the same (ideal) chain; the record engine at the size the gap workflow uses; cost against
// the number of sections.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "chain/registry.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "simulate/record/exact_propagator.hpp"
#include "simulate/record/record_simulator.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace bodesmith;
using chain::make_block;
constexpr double kPi = std::numbers::pi;
constexpr double kZeros[] = {48.79, 14.8, 107.6, 63.68, 380.2, 221.6, 400.0, 365.6};
constexpr double kPoles[] = {47.49, 13.99, 126.4, 102.2, 214.9, 124.8, 652.1, 589.4};
constexpr double kFrequency = 100.0;

/// y = d(u) alone, as the disturbance generator makes it, then eight poles.
std::vector<simulate::ExactPropagator::Segment> generator(double seconds) {
  std::vector<simulate::ExactPropagator::Segment> out;
  for (int i = 0; i < static_cast<int>(2.0 * kFrequency * seconds); ++i) {
    simulate::ExactPropagator::Segment s;
    s.begin = i / (2.0 * kFrequency);
    s.end = (i + 1) / (2.0 * kFrequency);
    s.degree = 3;
    const double a[] = {0.3546, -0.6433, 0.2887};
    const double d[] = {-0.2398, 0.0838, 0.156};
    if (i % 2 == 0) {
      for (int k = 0; k < 3; ++k) s.coefficients[k + 1] = a[k];
    } else {  // x = 1 - s
      s.coefficients[0] = d[0] + d[1] + d[2];
      s.coefficients[1] = -d[0] - 2.0 * d[1] - 3.0 * d[2];
      s.coefficients[2] = d[1] + 3.0 * d[2];
      s.coefficients[3] = -d[2];
    }
    out.push_back(s);
  }
  return out;
}

Sections sections(int count) {
  Sections s;
  if (count == 8) {
    for (int i = 0; i < 8; ++i) s.sections.push_back({1.0, {-kZeros[i]}, {-kPoles[i]}});
    return s;
  }
  // Alternating poles and zeros over six decades.
  for (int i = 0; i < count; ++i) {
    const double w = 2.0 * kPi * 0.1 * std::pow(10.0, 6.0 * (i + 0.5) / count);
    const double part = std::pow(10.0, 1.5 / count);
    s.sections.push_back({1.0, {-w * part}, {-w / part}});
  }
  return s;
}

/// The same chain as a model: y = u + d(u), then the poles.
chain::Chain model() {
  chain::Chain out{{make_block("polynomial_hysteresis")
                        .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                        .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156})}};
  for (int i = 0; i < 8; ++i) {
    out.blocks.push_back(make_block("pole_zero")
                             .set("zero_hz", kZeros[i] / (2.0 * kPi))
                             .set("pole_hz", kPoles[i] / (2.0 * kPi)));
  }
  return out;
}

TimeRecord triangle(double step, double seconds) {
  TimeRecord r;
  r.step_s = step;
  const auto n = static_cast<std::size_t>(std::lround(seconds / step)) + 1;
  const auto half = static_cast<std::size_t>(std::lround(0.5 / kFrequency / step));
  for (std::size_t i = 0; i < n; ++i) {
    const double p = static_cast<double>(i % half) / static_cast<double>(half);
    r.u.push_back((i / half) % 2 == 0 ? p : 1.0 - p);
  }
  return r;
}

double worst(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

void exact_million_samples(benchmark::State& state) {
  const auto segments = generator(1.0);
  const auto modes = simulate::ModalSystem::from(state_space(sections(static_cast<int>(state.range(0)))));
  simulate::ExactPropagator exact(modes, 1e-6);
  std::vector<double> y(1000001);
  for (auto _ : state) {
    exact.rest_under(0.0);
    exact.run(segments, 0.0, y);
    benchmark::DoNotOptimize(y.data());
  }
  state.counters["condition"] = modes.condition;
}
BENCHMARK(exact_million_samples)->Arg(8)->Arg(25)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

void exact_ten_thousand_samples(benchmark::State& state) {
  const auto segments = generator(1.0);
  simulate::ExactPropagator exact(simulate::ModalSystem::from(state_space(sections(8))), 1e-4);
  std::vector<double> y(10001);
  for (auto _ : state) {
    exact.rest_under(0.0);
    exact.run(segments, 0.0, y);
    benchmark::DoNotOptimize(y.data());
  }
}
BENCHMARK(exact_ten_thousand_samples)->Unit(benchmark::kMicrosecond);

void engine(benchmark::State& state, simulate::Engine which, double step, double tolerance) {
  const TimeRecord input = triangle(step, 1.0);
  const chain::Chain chain = model();
  simulate::Options options;
  options.engine = which;
  options.relative_tolerance = tolerance;
  options.absolute_tolerance = 1e-2 * tolerance;
  options.estimate_error = false;
  simulate::Result result;
  for (auto _ : state) result = simulate::simulate(chain, input, options);
  simulate::Options exact;
  exact.engine = simulate::Engine::exact;
  state.counters["worst_error"] = worst(result.y, simulate::simulate(chain, input, exact).y);
  state.counters["steps"] = static_cast<double>(result.stats.steps);
}
BENCHMARK_CAPTURE(engine, exact_from_a_million_samples, simulate::Engine::exact, 1e-6, 1e-6)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(engine, cvode_1e6, simulate::Engine::cvode, 1e-4, 1e-6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(engine, cvode_1e9, simulate::Engine::cvode, 1e-4, 1e-9)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(engine, record_ten_thousand_samples, simulate::Engine::record, 1e-4, 1e-6)
    ->Unit(benchmark::kMillisecond);

/// Pole-zero blocks in series, poles over `decades` upwards from 1 Hz, a 2 Hz triangle: cost against the
/// number of blocks. Many decades are stiff (BDF), two are not (Adams).
void blocks_in_series(benchmark::State& state, simulate::Engine which, double decades) {
  const auto count = static_cast<int>(state.range(0));
  chain::Chain chain;
  for (int i = 0; i < count; ++i) {
    const double pole = std::pow(10.0, decades * (i + 0.5) / count);
    const double zero = pole * std::pow(10.0, 0.3 / count);
    chain.blocks.push_back(make_block("pole_zero").set("pole_hz", pole).set("zero_hz", zero));
  }
  simulate::ReferenceSpec spec;
  spec.frequency = Hertz{2.0};
  spec.step_s = 1e-3;
  const TimeRecord input = simulate::make_reference(spec);
  simulate::Options options;
  options.engine = which;
  options.relative_tolerance = 1e-6;
  options.absolute_tolerance = 1e-8;
  options.estimate_error = false;
  simulate::Result result;
  for (auto _ : state) result = simulate::simulate(chain, input, options);
  state.counters["steps"] = static_cast<double>(result.stats.steps);
  state.counters["evaluations"] = static_cast<double>(result.stats.evaluations);
}
BENCHMARK_CAPTURE(blocks_in_series, cvode_stiff, simulate::Engine::cvode, 5.0)
    ->Arg(10)
    ->Arg(50)
    ->Arg(200)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(blocks_in_series, cvode_not_stiff, simulate::Engine::cvode, 1.5)
    ->Arg(10)
    ->Arg(50)
    ->Arg(200)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(blocks_in_series, record, simulate::Engine::record, 5.0)
    ->Arg(10)
    ->Arg(50)
    ->Arg(200)
    ->Unit(benchmark::kMillisecond);

/// A million, half and a quarter of that: cost against the number of samples.
void exact_samples(benchmark::State& state) {
  const auto segments = generator(1.0);
  const auto count = static_cast<std::size_t>(state.range(0));
  simulate::ExactPropagator exact(simulate::ModalSystem::from(state_space(sections(8))),
                                  1.0 / static_cast<double>(count));
  std::vector<double> y(count + 1);
  for (auto _ : state) {
    exact.rest_under(0.0);
    exact.run(segments, 0.0, y);
    benchmark::DoNotOptimize(y.data());
  }
}
BENCHMARK(exact_samples)->Arg(250000)->Arg(500000)->Arg(1000000)->Unit(benchmark::kMillisecond);

void ngspice_ideal(benchmark::State& state) {
  if (!ngspice::is_available()) {
    state.SkipWithError("ngspice is not installed");
    return;
  }
  std::string deck = "switched cubic, eight poles\n";
  deck += fmt::format("Vx x 0 PULSE(0 1 0 {0} {0} 1e-12 {1})\n", 0.5 / kFrequency, 1.0 / kFrequency);
  deck += fmt::format("Vb b 0 PULSE(1 0 {0} 1e-9 1e-9 {0} {1})\n", 0.5 / kFrequency, 1.0 / kFrequency);
  deck +=
      "Eu n0 0 VALUE={V(x)+(V(b)>0.5 ? V(x)*(0.3546+V(x)*(-0.6433+V(x)*0.2887)) : "
      "V(x)*(-0.2398+V(x)*(0.0838+V(x)*0.156)))}\n";
  for (int i = 0; i < 8; ++i) {
    // x' = p (u - x), y = x + (p/z) (u - x) on a unit capacitor
    deck += fmt::format(
        "G{0} 0 s{0} VALUE={{{2}*(V(n{0})-V(s{0}))}}\nC{0} s{0} 0 1 IC=0\nR{0} s{0} 0 1e12\nE{0} n{1} 0 "
        "VALUE={{V(s{0})+{3}*(V(n{0})-V(s{0}))}}\n",
        i, i + 1, kPoles[i], kPoles[i] / kZeros[i]);
  }
  ngspice::Transient got;
  for (auto _ : state) got = ngspice::run_transient(deck, {"n8"}, 1e-5, 1.0, "bench.cir");
  simulate::Options exact;
  exact.engine = simulate::Engine::exact;
  const TimeRecord input = triangle(1e-5, 1.0);
  const auto wanted = simulate::simulate(model(), input, exact).y;
  double most = 0.0;
  for (std::size_t i = 0; i < got.time_s.size(); ++i) {
    const double at = got.time_s[i] / 1e-5;
    const auto k = std::min(static_cast<std::size_t>(at), wanted.size() - 2);
    most = std::max(most, std::abs(got.v[0][i] - (wanted[k] + (at - static_cast<double>(k)) *
                                                                  (wanted[k + 1] - wanted[k]))));
  }
  state.counters["worst_error"] = most;
  state.counters["points"] = static_cast<double>(got.time_s.size());
}
BENCHMARK(ngspice_ideal)->Unit(benchmark::kMillisecond)->Iterations(1);

/// 20 000 samples through three blocks, one parameter changed before each run.
void record_of_gap(benchmark::State& state, const chain::Chain& chain) {
  std::vector<double> u(20000);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double t = 0.0016384 * static_cast<double>(i);
    u[i] = 0.05 * std::sin(2.0 * kPi * 31.0 * t) + 0.04 * std::sin(2.0 * kPi * 67.0 * t + 1.0);
  }
  simulate::RecordSimulator simulator(chain, 0.0016384);
  double change = 0.0;
  for (auto _ : state) {
    change += 1e-6;
    simulator.chain().blocks[0].set("gain", 1.0 + change);
    benchmark::DoNotOptimize(simulator.run(u).data());
  }
  state.counters["degree"] = simulator.degree();
}
BENCHMARK_CAPTURE(record_of_gap, linear,
                  chain::Chain{
                      {make_block("gain"), make_block("lowpass").set("corner_hz", 200.0),
                       make_block("resonator").set("natural_frequency_hz", 65.0).set("damping_ratio", 0.05)}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record_of_gap, duffing,
                  chain::Chain{{make_block("gain"), make_block("lowpass").set("corner_hz", 200.0),
                                make_block("resonator")
                                    .set("natural_frequency_hz", 65.0)
                                    .set("damping_ratio", 0.05)
                                    .set("cubic", 3.0)}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record_of_gap, backlash,
                  chain::Chain{{make_block("gain"), make_block("backlash").set("width", 0.02),
                                make_block("lowpass").set("corner_hz", 200.0)}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record_of_gap, saturation,
                  chain::Chain{{make_block("gain"),
                                make_block("saturation").set("lower", -0.06).set("upper", 0.06),
                                make_block("lowpass").set("corner_hz", 200.0)}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record_of_gap, delay,
                  chain::Chain{{make_block("gain"), make_block("delay").set("delay_s", 0.0021),
                                make_block("lowpass").set("corner_hz", 200.0)}})
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
