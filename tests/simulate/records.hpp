#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "signal/time_record.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

// Inputs and options that the tests of the engines share.

inline constexpr double kPi = std::numbers::pi;

inline TimeRecord record_of(std::size_t n, double step, double (*f)(double), double start = 0.0) {
  TimeRecord r;
  r.start_s = start;
  r.step_s = step;
  for (std::size_t i = 0; i < n; ++i) r.u.push_back(f(r.time_s(i)));
  return r;
}

inline double two_sines(double t) {
  return 0.7 * std::sin(2.0 * kPi * 5.0 * t) + 0.4 * std::sin(2.0 * kPi * 13.0 * t + 1.0);
}
inline double ramp(double t) {
  return t;
}
inline double one(double) {
  return 1.0;
}
inline double triangle(double t) {
  const double p = 4.0 * t - std::floor(4.0 * t);
  return p < 0.5 ? 2.0 * p : 2.0 - 2.0 * p;
}

inline Options cvode(double tolerance = 1e-11, Start start = Start::zero) {
  Options o;
  o.engine = Engine::cvode;
  o.relative_tolerance = tolerance;
  o.absolute_tolerance = 1e-2 * tolerance;
  o.start = start;
  o.estimate_error = false;
  return o;
}
inline Options by_record(std::size_t oversample = 1, Start start = Start::zero) {
  Options o;
  o.engine = Engine::record;
  o.oversample = oversample;
  o.start = start;
  o.estimate_error = false;
  return o;
}

inline double max_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double max = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) max = std::max(max, std::abs(a[i] - b[i]));
  return max;
}

}  // namespace bodesmith::simulate
