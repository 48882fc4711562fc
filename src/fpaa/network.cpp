#include "fpaa/network.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fpaa/cams/biquad_stage.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// All of these take cycles per master clock.
Complex make_d(double f, std::int64_t divisor, std::int64_t) {
  const double half = std::numbers::pi * f * static_cast<double>(divisor);
  // 1 - exp(-2j half), without cancellation where it is small.
  return std::polar(2.0 * std::sin(half), 0.5 * std::numbers::pi - half);
}
Complex make_read(double f, std::int64_t source, std::int64_t reader) {
  const std::int64_t g = std::gcd(source, reader);
  const double count = static_cast<double>(source / g);
  const double half = std::numbers::pi * f * static_cast<double>(g);
  if (source == g || std::abs(std::sin(half)) < 1e-12) return 1.0;
  return std::polar(std::sin(count * half) / (count * std::sin(half)), -half * (count - 1.0));
}
Complex make_hold(double f, std::int64_t divisor, std::int64_t) {
  const double half = std::numbers::pi * f * static_cast<double>(divisor);
  return std::polar(half < 1e-9 ? 1.0 : std::sin(half) / half, -half);
}

/// Without the care for overflow that the operator takes: everything here is of moderate size.
Complex quotient(Complex above, Complex below) {
  return above * std::conj(below) / std::norm(below);
}

}  // namespace

int NetworkStage::capacitor_count() const {
  return static_cast<int>(std::count_if(c.begin(), c.end(), [](double v) { return v > 0.0; }));
}

Complex NetworkStage::response(std::size_t input, Complex d) const {
  if (kind == Kind::first) {
    const std::size_t n = from.size();
    return -quotient(c[2 * input] + c[2 * input + 1] * d, c[2 * n] + c[2 * n + 1] * d);
  }
  const Complex late = 1.0 - d;
  const double sign = c1_inverting ? 1.0 : -1.0;
  const Complex first = sign * c[kC1] * c[kC3] * late;
  const Complex last = c[kCpp] * c[kCA] * d * d;
  if (kind == Kind::second_low) {
    return -quotient(first + c[kCp] * c[kCA] * d + last,
                     c[kCA] * d * (c[kCB] * d + c[kC4]) + c[kC2] * c[kC3] * late);
  }
  return -quotient(first + c[kCp] * c[kC3] * d * late + last,
                   c[kCA] * c[kCB] * d * d + c[kC3] * late * (c[kC2] + c[kC4] * d));
}

bool NetworkStage::is_stable() const {
  if (kind == Kind::first) return c[2 * from.size()] > 0.0;
  return BiquadStageCapacitors{.high_q = kind == Kind::second_high,
                               .c2 = c[kC2],
                               .c3 = c[kC3],
                               .c4 = c[kC4],
                               .ca = c[kCA],
                               .cb = c[kCB]}
      .transfer()
      .in_z()
      .is_stable();
}

double NetworkStage::largest_units(std::size_t capacitor, int max_capacitor) const {
  const bool banks = kind != Kind::first && (capacitor == kCA || capacitor == kCB) && capacitor_count() <= 6;
  return banks ? 2.0 * max_capacitor : max_capacitor;
}

int Network::opamps() const {
  int out = 0;
  for (const NetworkStage& stage : stages) out += stage.opamps();
  return out;
}

const std::vector<Complex>& NetworkResponse::kept(std::deque<Kept>& list, std::int64_t a, std::int64_t b,
                                                  Complex (*make)(double, std::int64_t, std::int64_t)) const {
  for (const Kept& entry : list) {
    if (entry.a == a && entry.b == b) return entry.values;
  }
  list.push_back({a, b, {}});
  for (const RadPerSecond w : target_.grid) {
    list.back().values.push_back(make(w.hz().value / target_.master_hz, a, b));
  }
  return list.back().values;
}

const std::vector<Complex>& NetworkResponse::d_of(std::int64_t divisor) const {
  return kept(d_, divisor, 0, make_d);
}
const std::vector<Complex>& NetworkResponse::read_of(std::int64_t source, std::int64_t reader) const {
  return kept(read_, source, reader, make_read);
}
const std::vector<Complex>& NetworkResponse::hold_of(std::int64_t divisor) const {
  return kept(hold_, divisor, 0, make_hold);
}

std::vector<std::vector<Complex>> NetworkResponse::nodes(const Network& network) const {
  const std::size_t points = target_.grid.size();
  std::vector<std::vector<Complex>> out;
  for (const NetworkStage& stage : network.stages) {
    const std::vector<Complex>& d = d_of(stage.divisor);
    std::vector<Complex> node(points, 0.0);
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      if (stage.from[i] == NetworkStage::kBoardInput) {
        for (std::size_t k = 0; k < points; ++k) node[k] += stage.response(i, d[k]);
        continue;
      }
      const auto source = static_cast<std::size_t>(stage.from[i]);
      const std::vector<Complex>& read = read_of(network.stages[source].divisor, stage.divisor);
      for (std::size_t k = 0; k < points; ++k) node[k] += stage.response(i, d[k]) * read[k] * out[source][k];
    }
    out.push_back(std::move(node));
  }
  return out;
}

std::vector<Complex> NetworkResponse::output(const Network& network) const {
  std::vector<Complex> out = nodes(network).back();
  const std::vector<Complex>& hold = hold_of(network.stages.back().divisor);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] *= hold[k];
  return out;
}

std::vector<Complex> NetworkResponse::errors(const Network& network) const {
  std::vector<Complex> out = output(network);
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = target_.weight[k] * target_.reciprocal[k] * (out[k] - target_.wanted[k]);
  }
  return out;
}

std::vector<std::vector<Complex>> NetworkResponse::onward(const Network& network) const {
  const std::size_t points = target_.grid.size();
  const std::size_t count = network.stages.size();
  std::vector<std::vector<Complex>> out(count, std::vector<Complex>(points, 0.0));
  out[count - 1] = hold_of(network.stages.back().divisor);
  for (std::size_t s = count; s-- > 0;) {
    const NetworkStage& stage = network.stages[s];
    const std::vector<Complex>& d = d_of(stage.divisor);
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      if (stage.from[i] == NetworkStage::kBoardInput) continue;
      const auto source = static_cast<std::size_t>(stage.from[i]);
      const std::vector<Complex>& read = read_of(network.stages[source].divisor, stage.divisor);
      for (std::size_t k = 0; k < points; ++k) {
        out[source][k] += stage.response(i, d[k]) * read[k] * out[s][k];
      }
    }
  }
  return out;
}

double largest_error(const std::vector<Complex>& errors) {
  double out = 0.0;
  for (const Complex& e : errors) {
    // Not std::max: a NaN has to come out as the worst.
    if (!(std::abs(e) <= out)) out = std::isnan(std::abs(e)) ? 1e300 : std::abs(e);
  }
  return out;
}

}  // namespace bodesmith::fpaa
