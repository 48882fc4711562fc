#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "hysteresis/model_type.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis::testing {

/// Straight moves between turning points, `steps` samples each.
inline std::vector<double> through(const std::vector<double>& points, int steps) {
  std::vector<double> out{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i)
    for (int k = 1; k <= steps; ++k)
      out.push_back(points[i - 1] + (points[i] - points[i - 1]) * k / static_cast<double>(steps));
  return out;
}

/// Triangle between low and high whose amplitude is modulated, starting at low.
inline std::vector<double> modulated_triangle(std::size_t n, double low, double high, int samples_a_branch) {
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double cycle = static_cast<double>(i) / (2.0 * samples_a_branch);
    const double phase = cycle - std::floor(cycle);
    const double triangle = phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase;
    const double envelope = i < static_cast<std::size_t>(2 * samples_a_branch)
                                ? 1.0
                                : 0.55 + 0.45 * std::cos(2.0 * 3.14159265358979 * cycle / 7.3);
    out[i] = 0.5 * (low + high) + 0.5 * (high - low) * envelope * triangle;
  }
  return out;
}

/// A small generator of its own, so that the tests do not lean on the program's.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2862933555777941757ULL + 3037000493ULL) {}
  double uniform() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<double>(state_ >> 11) * 0x1.0p-53;
  }
  double normal() {
    return std::sqrt(-2.0 * std::log(1.0 - uniform())) * std::cos(6.283185307179586 * uniform());
  }

 private:
  std::uint64_t state_;
};

/// Random turning points within [low, high].
inline std::vector<double> random_walk(Random& random, double low, double high, int turns, int steps) {
  std::vector<double> points{low};
  for (int i = 0; i < turns; ++i) points.push_back(low + (high - low) * random.uniform());
  return through(points, steps);
}

inline TimeRecord record(std::vector<double> u, std::vector<double> y, double step_s = 1e-3) {
  TimeRecord out;
  out.file = "record";
  out.step_s = step_s;
  out.u = std::move(u);
  out.y = std::move(y);
  return out;
}

/// What an identified model is off by, over the samples from skip_s on; percent of the records' range.
struct Errors {
  double rms = 0.0;
  double rms_percent = 0.0;
};
inline Errors errors_of(const Identified& found, std::span<const TimeRecord> records, double skip_s = 0.0) {
  double squares = 0.0;
  double count = 0.0;
  double low = INFINITY;
  double high = -INFINITY;
  for (const TimeRecord& one : records) {
    const auto op = make_operator(found.model);
    for (std::size_t i = 0; i < one.size(); ++i) {
      const double h =
          i == 0 ? op->reset(found.input(one.u[0])) : op->step(found.input(one.u[i]), one.step_s);
      if (static_cast<double>(i) * one.step_s < skip_s - 1e-9) continue;
      squares += std::pow(found.output(h) - one.y[i], 2);
      count += 1.0;
      low = std::min(low, one.y[i]);
      high = std::max(high, one.y[i]);
    }
  }
  const double rms = std::sqrt(squares / count);
  return {rms, 100.0 * rms / (high - low)};
}

}  // namespace bodesmith::hysteresis::testing
