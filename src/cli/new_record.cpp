#include <cmath>
#include <numbers>

#include "chain/registry.hpp"
#include "cli/new_projects.hpp"
#include "numeric/random.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {
namespace {

/// Three sines that share no period; their frequencies in Hz.
TimeRecord example_input(const std::array<double, 3>& frequencies) {
  TimeRecord out;
  out.step_s = 2e-4;
  for (int i = 0; i < 4000; ++i) {
    double u = 0.5;
    double amplitude = 0.18;
    for (const double f : frequencies) {
      u += amplitude * std::sin(2.0 * std::numbers::pi * f * i * out.step_s);
      amplitude *= 0.8;
    }
    out.u.push_back(u);
  }
  return out;
}

}  // namespace

/// What a stage answers that has a lag which model.toml does not know, measured with some noise.
std::string example_record(const std::array<double, 3>& frequencies, std::uint64_t seed) {
  const TimeRecord input = example_input(frequencies);
  chain::Chain stage;
  stage.blocks = {chain::make_block("gain").set("gain", 0.95).set("offset", 0.02),
                  chain::make_block("lowpass").set("corner_hz", 180.0)};
  std::vector<double> y = simulate::simulate(stage, input).y;
  std::vector<double> time(y.size());
  Random noise(seed);
  for (std::size_t i = 0; i < y.size(); ++i) {
    time[i] = input.time_s(i);
    y[i] += 2e-4 * noise.normal();
  }
  CsvWriter csv;
  csv.add(column::time_s, time);
  csv.add(column::input, input.u);
  csv.add(column::output, y);
  return csv.text();
}

}  // namespace bodesmith::cli
