#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "chain/registry.hpp"
#include "cli/new_projects.hpp"
#include "numeric/random.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {
namespace {

std::string answer_to(const std::string& question, const std::string& standard) {
  hide_progress();
  fmt::print("{} [{}]: ", question, standard);
  std::fflush(stdout);
  std::string out;
  if (!std::getline(std::cin, out)) throw InputError("no answer, expected one line");
  return std::string(trim(out));
}

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

Answers::Answers(const CommandLine& line)
    : line_(line), asks_(!line.has("kind") && on_terminal(STDIN_FILENO) && on_terminal(STDOUT_FILENO)) {}

std::string Answers::text(const std::string& option, const std::string& question) const {
  const std::string standard = line_.maybe<std::string>(option).value_or("");
  if (!asks_ || line_.has(option)) return standard;
  const std::string given = answer_to(question, standard);
  return given.empty() ? standard : given;
}

double Answers::number(const std::string& option, const std::string& question) const {
  const double standard = line_.positive(option);
  if (!asks_ || line_.has(option)) return standard;
  const std::string given = answer_to(question, rounded_text(standard));
  double value = standard;
  if (!given.empty() && (!parse_quantity(given, value) || !(value > 0.0)))
    line_.fail(fmt::format("'{}' is no number above 0", given));
  return value;
}

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
