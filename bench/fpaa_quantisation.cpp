// How well whole-number capacitors make filters: our choice against the vendor's, at the same clock, for
// random sections with clock/corner ratios of 20 to 1500; and how long the searches take.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "fpaa/cams/filter_bilinear.hpp"
#include "fpaa/chain_search.hpp"
#include "fpaa/plan.hpp"
#include "fpaa/section_search.hpp"

namespace {

using namespace bodesmith;
using namespace bodesmith::fpaa;
using Complex = std::complex<double>;

constexpr int kSections = 1000;
constexpr double kClock = 250e3;

struct Random {
  RadPerSecond zero, pole;
  double gain;
};

std::vector<Random> random_sections() {
  std::mt19937_64 random(2026);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
  };
  std::vector<Random> out;
  for (int i = 0; i < kSections; ++i) {
    const double ratio = std::exp(uniform(std::log(20.0), std::log(1500.0)));
    const double pole = kClock / ratio;
    const double zero = std::min(pole * std::exp(uniform(-0.7, 0.7)), kClock / 20.0);
    out.push_back(
        {Hertz{std::max(zero, kClock / 1600.0)}.rad_s(), Hertz{pole}.rad_s(), std::exp(uniform(-1.0, 1.0))});
  }
  return out;
}

std::vector<RadPerSecond> grid_around(const Random& s) {
  std::vector<RadPerSecond> out;
  const double low = std::min(s.zero.value, s.pole.value) / 10.0;
  const double high =
      std::min(std::max(s.zero.value, s.pole.value) * 10.0, Hertz{0.1 * kClock}.rad_s().value);
  for (const Hertz f : log_grid({RadPerSecond{low}.hz(), RadPerSecond{high}.hz()}, 32))
    out.push_back(f.rad_s());
  return out;
}

/// Pole and zero each rounded as the vendor's scan rounds the low pass: the largest C1 first, C0 =
/// round(C1/ratio), the first set with the least corner error. (Its own scan for this option is not publicly
/// known.)
PoleZeroCapacitors scan_like_vendor(const Random& s) {
  const auto branch = [](RadPerSecond corner, int& c0, int& c1) {
    const double ratio = branch_ratio(corner.hz(), {kClock});
    double least = 1e9;
    for (int c = 255; c >= 1; --c) {
      const double first = std::round(c / ratio);
      if (first < 1.0 || first > 255.0) continue;
      const double error = std::abs(branch_corner(first, c, {kClock}).value / corner.hz().value - 1.0);
      if (error < least) {
        least = error;
        c0 = static_cast<int>(first);
        c1 = c;
      }
    }
  };
  PoleZeroCapacitors out;
  branch(s.zero, out.ca, out.cb);
  branch(s.pole, out.cc, out.cd);
  return out;
}

double own_error(const PoleZeroCapacitors& c, const Random& s, const std::vector<RadPerSecond>& grid) {
  std::vector<Complex> q;
  for (const RadPerSecond w : grid) {
    const Complex wanted = Complex(1.0, w.value / s.zero.value) / Complex(1.0, w.value / s.pole.value);
    q.push_back(-c.transfer().response(w, {kClock}) / c.dc_gain() / wanted);
  }
  return best_free_gain(q).error;
}

void report(benchmark::State& state, const char* name, std::vector<double> percent) {
  std::sort(percent.begin(), percent.end());
  state.counters[std::string(name) + "_median_percent"] = percent[percent.size() / 2];
  state.counters[std::string(name) + "_p95_percent"] = percent[percent.size() * 95 / 100];
  state.counters[std::string(name) + "_max_percent"] = percent.back();
}

void pole_zero_sections(benchmark::State& state) {
  const auto sections = random_sections();
  std::vector<double> ours, scan;
  for (auto _ : state) {
    ours.clear();
    scan.clear();
    for (const Random& s : sections) {
      const auto grid = grid_around(s);
      ours.push_back(100.0 * best_pole_zero(s.zero, s.pole, {kClock}, grid).max_complex_error);
      scan.push_back(100.0 * own_error(scan_like_vendor(s), s, grid));
    }
  }
  report(state, "proven", ours);
  report(state, "scan", scan);
  double worse = 0.0;
  for (size_t i = 0; i < ours.size(); ++i) worse += ours[i] > scan[i] * (1.0 + 1e-9) ? 1.0 : 0.0;
  state.counters["scan_better"] = worse;
}
BENCHMARK(pole_zero_sections)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Complex error of a low pass (gain included) against the analogue one with the CAM's own zero at z = 0, so
/// that only the capacitors count.
double low_pass_error(const LowPassCapacitors& c, double corner, double gain) {
  const double ratio = branch_ratio({corner}, {kClock});
  double worst = 0.0;
  for (const Hertz f : log_grid({{corner / 10.0}, {std::min(corner * 10.0, 0.1 * kClock)}}, 32)) {
    const Complex d = 1.0 - std::polar(1.0, -f.rad_s().value / kClock);
    worst = std::max(worst,
                     std::abs(-c.transfer().response(f.rad_s(), {kClock}) * (1.0 + ratio * d) / gain - 1.0));
  }
  return worst;
}

/// What the program's own search makes of it.
LowPassCapacitors best_low_pass(double corner, double gain) {
  ChainProblem problem;
  problem.clock = {kClock};
  problem.branches = {{Branch::Kind::constant, {}, true, 0},
                      {Branch::Kind::corner, Hertz{corner}.rad_s(), false, 0}};
  problem.log_gain = std::log(gain);
  problem.cam_log_gain = {std::log(gain)};
  const double ratio = branch_ratio({corner}, {kClock});
  for (const Hertz f : log_grid({{corner / 10.0}, {std::min(corner * 10.0, 0.1 * kClock)}}, 32)) {
    const RadPerSecond w = f.rad_s();
    problem.grid.push_back(w);
    // The same yardstick as low_pass_error: the CAM's own zero does not count.
    const Complex sampled = 1.0 + ratio * (1.0 - std::polar(1.0, -w.value / kClock));
    problem.others.push_back(std::log(sampled) - std::log(Complex(1.0, f.value / corner)));
  }
  const ChainSolution solution = search_chain(problem, {});
  return {solution.values[0].c0, solution.values[1].c1, solution.values[1].c0};
}

void low_pass_sections(benchmark::State& state) {
  const auto sections = random_sections();
  std::vector<double> ours, vendor;
  for (auto _ : state) {
    ours.clear();
    vendor.clear();
    for (const Random& s : sections) {
      const double corner = s.pole.hz().value;
      ours.push_back(100.0 * low_pass_error(best_low_pass(corner, s.gain), corner, s.gain));
      vendor.push_back(100.0 * low_pass_error(vendor_low_pass({corner}, s.gain, {kClock}), corner, s.gain));
    }
  }
  double worse = 0.0;
  for (size_t i = 0; i < ours.size(); ++i) worse += ours[i] > vendor[i] * (1.0 + 1e-9) ? 1.0 : 0.0;
  state.counters["vendor_better"] = worse;
  report(state, "ours", ours);
  report(state, "vendor", vendor);
}
BENCHMARK(low_pass_sections)->Unit(benchmark::kMillisecond)->Iterations(1);

void seed_plan(benchmark::State& state) {
  const double table[4][5] = {{0.918, 48.79, 14.8, 47.49, 13.99},
                              {1.885, 107.6, 63.68, 126.4, 102.2},
                              {0.318, 380.2, 221.6, 214.9, 124.8},
                              {2.628, 400.0, 365.6, 652.1, 589.4}};
  Sections sections;
  for (const auto& row : table) {
    sections.sections.push_back({row[0], {-row[1], -row[2]}, {-row[3], -row[4]}});
  }
  PlanOptions options;
  options.band = Band{{1.0}, {100.0}};
  if (state.range(0) > 0) options.clock = Hertz{static_cast<double>(state.range(0))};
  Plan plan;
  for (auto _ : state) plan = value_or_throw(make_plan(sections, options));
  state.counters["max_complex_percent"] = plan.error.max_complex_percent;
  state.counters["clock_hz"] = plan.cams()[0]->clock_a.value;
}
BENCHMARK(seed_plan)->Arg(2000)->Arg(0)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
