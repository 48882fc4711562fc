#include "fpaa/network.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fpaa/clocked_factors.hpp"
#include "fpaa/grid_arithmetic.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// All of these take cycles per master clock.
Complex make_d(double f, std::int64_t divisor, std::int64_t) {
  return difference_factor(std::numbers::pi * f * static_cast<double>(divisor));
}
Complex make_read(double f, std::int64_t source, std::int64_t reader) {
  const std::int64_t g = std::gcd(source, reader);
  return mean_factor(static_cast<double>(source / g), std::numbers::pi * f * static_cast<double>(g));
}
Complex make_hold(double f, std::int64_t divisor, std::int64_t) {
  return hold_factor(std::numbers::pi * f * static_cast<double>(divisor));
}

/// Without the care for overflow that the operator takes: everything here is of moderate size.
Complex quotient(Complex above, Complex below) {
  return above * std::conj(below) / std::norm(below);
}

}  // namespace

InD denominator_of(const NetworkStage& stage) {
  using Stage = NetworkStage;
  const std::vector<double>& c = stage.c;
  // With 1/z = 1 - D.
  if (stage.kind == Stage::Kind::first) return {c[2 * stage.from.size()], c[2 * stage.from.size() + 1], 0.0};
  const bool low = stage.kind == Stage::Kind::second_low;
  const double loop = c[Stage::kC2] * c[Stage::kC3];
  const double damp = c[Stage::kC4] * (low ? c[Stage::kCA] : c[Stage::kC3]);
  return {loop, damp - loop, c[Stage::kCA] * c[Stage::kCB] - (low ? 0.0 : damp)};
}

InD numerator_of(const NetworkStage& stage, std::size_t input) {
  using Stage = NetworkStage;
  const std::vector<double>& c = stage.c;
  if (stage.kind == Stage::Kind::first) return {c[2 * input], c[2 * input + 1], 0.0};
  const bool low = stage.kind == Stage::Kind::second_low;
  const double first = (stage.c1_inverting ? 1.0 : -1.0) * c[Stage::kC1] * c[Stage::kC3];
  const double middle = c[Stage::kCp] * (low ? c[Stage::kCA] : c[Stage::kC3]);
  return {first, middle - first, c[Stage::kCpp] * c[Stage::kCA] - (low ? 0.0 : middle)};
}

StageOnGrid::StageOnGrid(const NetworkStage& stage, const std::vector<Complex>& d)
    : stage_(stage), d_(d), inverse_(inverse_of(denominator_of(stage), d)) {}

std::vector<Complex> StageOnGrid::response(std::size_t input) const {
  return negative_quotient(numerator_of(stage_, input), d_, inverse_);
}

std::vector<Complex> StageOnGrid::derivative(std::size_t input, std::size_t capacitor,
                                             const std::vector<Complex>& response) const {
  using Stage = NetworkStage;
  const std::vector<double>& c = stage_.c;
  // H = -N/M: dH = -(dN + H dM)/M, dN and dM by ln c, each a0 + a1 D + a2 D^2.
  double dn[3] = {0.0, 0.0, 0.0};
  double dm[3] = {0.0, 0.0, 0.0};
  if (stage_.kind == Stage::Kind::first) {
    const std::size_t n = stage_.from.size();
    if (capacitor >= 2 * n) {
      dm[capacitor - 2 * n] = c[capacitor];
    } else if (capacitor / 2 == input) {
      dn[capacitor % 2] = c[capacitor];
    } else {
      return std::vector<Complex>(d_.size(), 0.0);
    }
  } else {
    const bool low = stage_.kind == Stage::Kind::second_low;
    const double first = (stage_.c1_inverting ? 1.0 : -1.0) * c[Stage::kC1] * c[Stage::kC3];
    const double middle = c[Stage::kCp] * (low ? c[Stage::kCA] : c[Stage::kC3]);
    const double last = c[Stage::kCpp] * c[Stage::kCA];
    const double loop = c[Stage::kC2] * c[Stage::kC3];
    const double damp = c[Stage::kC4] * (low ? c[Stage::kCA] : c[Stage::kC3]);
    const double store = c[Stage::kCA] * c[Stage::kCB];
    const double late = low ? 0.0 : 1.0;
    const auto is = [&](int which) { return static_cast<int>(capacitor) == which; };
    const auto add = [&](double* to, double a0, double a1, double a2) {
      to[0] += a0;
      to[1] += a1;
      to[2] += a2;
    };
    if (is(Stage::kC1) || is(Stage::kC3)) add(dn, first, -first, 0.0);
    if (is(Stage::kCp) || is(low ? Stage::kCA : Stage::kC3)) add(dn, 0.0, middle, -late * middle);
    if (is(Stage::kCpp) || is(Stage::kCA)) add(dn, 0.0, 0.0, last);
    if (is(Stage::kC2) || is(Stage::kC3)) add(dm, loop, -loop, 0.0);
    if (is(Stage::kC4) || is(low ? Stage::kCA : Stage::kC3)) add(dm, 0.0, damp, -late * damp);
    if (is(Stage::kCA) || is(Stage::kCB)) add(dm, 0.0, 0.0, store);
  }
  return negative_change({dn[0], dn[1], dn[2]}, {dm[0], dm[1], dm[2]}, d_, response, inverse_);
}

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
  // q0 + q1 D + q2 D^2 in powers of 1/z: Jury's conditions.
  const double loop = c[kC2] * c[kC3];
  const double damp = c[kC4] * (kind == Kind::second_low ? c[kCA] : c[kC3]);
  const double q1 = damp - loop;
  const double q2 = c[kCA] * c[kCB] - (kind == Kind::second_low ? 0.0 : damp);
  const double first = loop + q1 + q2;
  return std::abs(q2) < first && std::abs(q1 + 2.0 * q2) < first + q2;
}

double NetworkStage::inner_gain(Complex d) const {
  const Complex late = 1.0 - d;
  const double in = c1_inverting ? c[kC1] : -c[kC1];
  if (kind == Kind::second_low) {
    const Complex below = c[kCA] * d * (c[kCB] * d + c[kC4]) + c[kC2] * c[kC3] * late;
    return std::abs((in * (c[kC4] + c[kCB] * d) - c[kC2] * (c[kCp] + c[kCpp] * d)) / below);
  }
  const Complex below = c[kCA] * c[kCB] * d * d + c[kC3] * late * (c[kC2] + c[kC4] * d);
  return std::abs(d * ((in + c[kCp] * d) * c[kCB] - (c[kC2] + c[kC4] * d) * c[kCpp]) / below);
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

NetworkResponse::Transfers NetworkResponse::transfers(const Network& network) const {
  Transfers out;
  for (const NetworkStage& stage : network.stages) {
    const StageOnGrid on_grid(stage, d_of(stage.divisor));
    std::vector<std::vector<Complex>> inputs;
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      inputs.push_back(on_grid.response(i));
      if (stage.from[i] == NetworkStage::kBoardInput) continue;
      const std::int64_t source = network.stages[static_cast<std::size_t>(stage.from[i])].divisor;
      if (source == stage.divisor) continue;
      multiply(inputs.back(), read_of(source, stage.divisor));
    }
    out.push_back(std::move(inputs));
  }
  return out;
}

std::vector<std::vector<Complex>> NetworkResponse::nodes(const Network& network) const {
  return nodes(network, transfers(network));
}

std::vector<std::vector<Complex>> NetworkResponse::nodes(const Network& network,
                                                         const Transfers& made) const {
  const std::size_t points = target_.grid.size();
  std::vector<std::vector<Complex>> out;
  for (std::size_t s = 0; s < network.stages.size(); ++s) {
    const NetworkStage& stage = network.stages[s];
    std::vector<Complex> node(points, 0.0);
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      const std::vector<Complex>& way = made[s][i];
      if (stage.from[i] == NetworkStage::kBoardInput) {
        for (std::size_t k = 0; k < points; ++k) node[k] += way[k];
        continue;
      }
      add_product(node, way, out[static_cast<std::size_t>(stage.from[i])]);
    }
    out.push_back(std::move(node));
  }
  return out;
}

std::vector<Complex> NetworkResponse::output(const Network& network) const {
  std::vector<Complex> out = std::move(nodes(network).back());
  multiply(out, hold_of(network.stages.back().divisor));
  return out;
}

std::vector<Complex> NetworkResponse::errors(const Network& network) const {
  std::vector<Complex> out = output(network);
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = (target_.weight[k] * target_.reciprocal[k]) * (out[k] - target_.wanted[k]);
  }
  return out;
}

std::vector<std::vector<Complex>> NetworkResponse::onward(const Network& network) const {
  return onward(network, transfers(network));
}

std::vector<std::vector<Complex>> NetworkResponse::onward(const Network& network,
                                                          const Transfers& made) const {
  const std::size_t points = target_.grid.size();
  const std::size_t count = network.stages.size();
  std::vector<std::vector<Complex>> out(count, std::vector<Complex>(points, 0.0));
  out[count - 1] = hold_of(network.stages.back().divisor);
  for (std::size_t s = count; s-- > 0;) {
    const NetworkStage& stage = network.stages[s];
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      if (stage.from[i] == NetworkStage::kBoardInput) continue;
      add_product(out[static_cast<std::size_t>(stage.from[i])], made[s][i], out[s]);
    }
  }
  return out;
}

double largest_error(const std::vector<Complex>& errors) {
  double out = 0.0;
  for (const Complex& e : errors) {
    const double size = std::abs(e);
    // Not std::max: a NaN has to come out as the worst.
    if (!(size <= out)) out = std::isnan(size) ? 1e300 : size;
  }
  return out;
}

}  // namespace bodesmith::fpaa
