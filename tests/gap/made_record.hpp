#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "gap/made_model.hpp"
#include "signal/time_record.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith {

/// What a chain of these blocks of a model.toml makes of an input, with white noise of this rms.
inline TimeRecord measured(const std::string& truth, std::vector<double> input, double step_s, double noise,
                           unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = step_s;
  r.u = std::move(input);
  simulate::RecordSimulator simulator(model_of(truth), step_s);
  for (double y : simulator.run(r.u)) r.y.push_back(y + noise * normal(random));
  return r;
}

/// White noise x that is smoothed over 1/share samples; `sample(i, x, e)` makes u and y of it and of an e of the standard normal distribution.
template <class Sample>
TimeRecord of_smoothed_noise(const char* file, unsigned seed, int samples, double step_s,
                             const Sample& sample, double share = 0.1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = file;
  r.step_s = step_s;
  double x = 0.0;
  for (int i = 0; i < samples; ++i) {
    x += share * (normal(random) - x);
    const auto [u, y] = sample(i, x, normal(random));
    r.u.push_back(u);
    r.y.push_back(y);
  }
  return r;
}

/// So many samples, 1 ms apart, of a sine at hz and half of one at 2.7 hz.
inline std::vector<double> two_sines(int samples, double size, double hz) {
  std::vector<double> u;
  for (int i = 0; i < samples; ++i)
    u.push_back(size * (std::sin(2.0 * std::numbers::pi * hz * 1e-3 * i) +
                        0.5 * std::sin(2.0 * std::numbers::pi * 2.7 * hz * 1e-3 * i)));
  return u;
}

}  // namespace bodesmith
