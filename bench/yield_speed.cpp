// 100 000 circuits of sixteen poles (16 first-order stages, 64 parts) at 60 frequencies, on one core and on
// all.
#include <benchmark/benchmark.h>

#include "synthesis/realise.hpp"
#include "tolerance/yield.hpp"

namespace {

using namespace bodesmith;

void yield_sixteen_poles(benchmark::State& state) {
  Sections sections;
  for (int i = 0; i < 16; ++i) {
    const double w = 20.0 * std::pow(1.3, i);
    sections.sections.push_back(Section::pole_zero(1.0, {w}, {i % 2 == 0 ? 1.2 * w : w / 1.2}));
  }
  const tolerance::Design design = tolerance::design_of_circuit(
      synthesis::realise(sections).circuit, sections, "sixteen poles", tolerance::OpAmps::ideal);
  tolerance::Options options;
  options.samples = 100000;
  options.grid = log_grid({Hertz{1}, Hertz{1000}}, 60);
  options.threads = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(tolerance::run_monte_carlo(design, options, Team()).within);
}
BENCHMARK(yield_sixteen_poles)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
