#include "tolerance/controller/board.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace bodesmith::tolerance {
namespace {

using generator::DisturbanceCircuit;

constexpr int kNodes = 8;
using Basis = std::array<std::array<double, kNodes>, kNodes>;

double chebyshev_node(int i) {
  return std::cos(std::numbers::pi * (i + 0.5) / kNodes);
}

/// basis[i]: coefficients, in rising powers, of the polynomial that is 1 at node i and 0 at the others.
Basis lagrange_basis() {
  Basis out{};
  for (std::size_t i = 0; i < kNodes; ++i) {
    std::array<double, kNodes>& p = out[i];
    p[0] = 1.0;
    std::size_t degree = 0;
    for (int k = 0; k < kNodes; ++k) {
      if (static_cast<std::size_t>(k) == i) continue;
      const double at = chebyshev_node(k), below = chebyshev_node(static_cast<int>(i)) - at;
      ++degree;
      for (std::size_t d = degree; d > 0; --d) p[d] = (p[d - 1] - at * p[d]) / below;
      p[0] *= -at / below;
    }
  }
  return out;
}

double polynomial(const double* p, int terms, double t, double& slope) {
  double value = 0.0;
  slope = 0.0;
  for (int k = terms - 1; k >= 0; --k) {
    slope = slope * t + value;
    value = value * t + p[k];
  }
  return value;
}

/// Beyond the drives that occur nominally, V.
constexpr double kRoomV = 0.15;

}  // namespace

Input input_of(const tracking::Reference& reference, Hertz operating, std::size_t samples) {
  Input out;
  const double repeat_s = static_cast<double>(reference.periods()) / operating.value;
  out.step_s = repeat_s / static_cast<double>(samples);
  out.r = reference.samples(samples);
  const std::vector<double>& turns = reference.turns();
  for (std::size_t k = 0; k < samples; ++k) {
    const double theta = static_cast<double>(k) / static_cast<double>(samples);
    const double middle = theta + 0.5 / static_cast<double>(samples);
    std::size_t piece = reference.piece(theta);
    double since = theta - turns[piece];
    if (since < 1e-9) {  // at the turning point itself nothing has noticed it yet
      piece = piece == 0 ? turns.size() - 1 : piece - 1;
      since = theta - turns[piece] + (theta < turns[piece] + 1e-9 ? 1.0 : 0.0);
    }
    out.rising.push_back(tracking::Reference::rises(piece));
    out.to_turn.push_back(since * repeat_s);
    out.slope.push_back(reference.slope(middle, reference.piece(middle)) / repeat_s);
    out.greatest_slope = std::max(out.greatest_slope, std::abs(out.slope.back()));
  }
  return out;
}

Board::Board(const generator::RestWiring& wiring, const generator::Copy& copy, const Board* like)
    : wiring_(wiring),
      off_(copy.off),
      rest_(wiring, copy.off, like != nullptr ? &like->rest_ : nullptr),
      meter_(generator::SlopeMeterGains::of(wiring.circuit, copy.off)) {
  speed_ = std::max(1.0 + copy.speed, 0.05);
  timing_ = std::max(1.0 + copy.timing, 0.05);
  reference_gain_ = rest_.reference_gain();
  // In every copy, and throughout what it is at most: low, as droop is.
  if (const auto& stroke = wiring.circuit.stroke) rest_.set_stroke(1.0 - stroke->held_off(1.0));
  const double top = std::max(wiring.circuit.loop.greatest_drive, 1.0);
  middle_ = 0.5 * top;
  half_ = 0.5 * top + kRoomV;
  tabulate(true);
  tabulate(false);
  set_delays();
}

void Board::tabulate(bool rising) {
  static const Basis basis = lagrange_basis();
  const DisturbanceCircuit& c = wiring_.circuit;
  const std::size_t index = rising ? 0 : 1;
  Branch& b = branch_[index];
  b.varies = c.branches[index].rate.control >= 0;
  for (int volts = 0; volts < (b.varies ? kControls : 1); ++volts) {
    rest_.set_control(index, volts);
    for (int i = 0; i < kNodes; ++i) {
      const double x = middle_ + half_ * chebyshev_node(i);
      const double made = wiring_.argument_is_given ? rest_.made(0.0, x, index) : rest_.made(x, 0.0, index);
      for (int k = 0; k < kTerms; ++k) {
        b.term[volts][k] += made * basis[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
      }
    }
  }
}

/// The switch's common node while both contacts are open: an opening contact leaves its charge on what holds the
/// node, which discharges through the subtraction's input resistor until the other closes.
double Board::open_node_f() const {
  const DisturbanceCircuit& c = wiring_.circuit;
  const std::string& node = c.contacts.back().to;
  double out = 0.0;
  for (const schematic::Contact& one : c.contacts) out += one.to == node ? c.analog_switch.drain_f : 0.0;
  for (std::size_t i = 0; i < c.parts.size(); ++i) {
    const schematic::Part& part = c.parts[i];
    if (part.kind == schematic::Part::Kind::capacitor && (part.from == node || part.to == node))
      out += off_.value(c, static_cast<int>(i));
  }
  return out;
}

double Board::open_node_v() const {
  return (wiring_.circuit.analog_switch.charge_c + off_.switch_charge_c) / open_node_f();
}

double Board::open_node_ohm() const {
  return off_.value(wiring_.circuit, wiring_.circuit.passes.back().output.disturbance);
}

double Board::open_node_s() const {
  const double tau = open_node_ohm() * open_node_f();
  return tau * -std::expm1(-wiring_.circuit.analog_switch.gap_s / tau);
}

/// Closed-loop lag of an op-amp: its noise gain over 2 pi GBW.
void Board::set_delays() {
  const DisturbanceCircuit& c = wiring_.circuit;
  const generator::Pass& last = c.passes.back();
  const double per_gain = 1.0 / (2.0 * std::numbers::pi * c.opamp.gain_bandwidth.value * speed_);
  const double multiplier = 1.0 / (2.0 * std::numbers::pi * c.multiplier.bandwidth.value);
  output_s_ = c.opamp.is_ideal ? 0.0 : rest_.noise_gain(last.output.opamp) * per_gain;
  for (std::size_t b = 0; b < 2; ++b) {
    const int sum = last.branch_opamp[b];
    branch_[b].delay_s = 2.0 * multiplier;
    if (sum >= 0 && !c.opamp.is_ideal) branch_[b].delay_s += rest_.noise_gain(sum) * per_gain;
  }
  const double feedback = off_.value(c, last.output.feedback);
  if (c.switched()) charge_area_ = open_node_v() * open_node_s() * feedback / open_node_ohm();
}

std::vector<double> Board::slope_voltage(const Input& input) const {
  const std::size_t n = input.r.size();
  std::vector<double> out(n, 0.0);
  if (meter_.volts == 0.0) return out;
  const generator::SlopeMeterGains& m = meter_;
  double a = 0.0, b = 0.0, sn = 0.0;
  // Steps are of few lengths: what is left of a lag over one is worked out once for each.
  struct Left {
    double h = -1.0, a = 0.0, b = 0.0, sn = 0.0;
  };
  const auto left_of = [&m](double h) {
    const auto part = [h](double lag_s) { return lag_s > 0.0 ? std::exp(-h / lag_s) : 0.0; };
    return Left{h, part(m.lag1_s), part(m.lag2_s), part(m.smoothing_s)};
  };
  const double lag = std::max(m.lag1_s, m.lag2_s), settled = 0.01 * input.greatest_slope;
  const Left whole = left_of(input.step_s), small = left_of(0.5 * lag);
  Left rest;
  const auto advance = [&](double slope, const Left& left) {
    a = slope + (a - slope) * left.a;
    b = a + (b - a) * left.b;
    const double to = m.output_v(b);
    sn = to + (sn - to) * left.sn;
  };
  a = b = input.slope[n - 1];
  sn = m.output_v(b);
  for (int round = 0; round < 2; ++round) {
    for (std::size_t k = 0; k < n; ++k) {
      out[k] = sn;
      double left = input.step_s;
      // Small steps only while the differentiator is on its way.
      while (left > 0.5 * lag &&
             (std::abs(a - input.slope[k]) > settled || std::abs(b - input.slope[k]) > settled)) {
        advance(input.slope[k], small);
        left -= 0.5 * lag;
      }
      if (left != input.step_s && left != rest.h) rest = left_of(left);
      advance(input.slope[k], left == input.step_s ? whole : rest);
    }
  }
  return out;
}

void Board::mix(const Branch& branch, double control_v, double out[kTerms]) const {
  if (!branch.varies) {
    std::copy(branch.term[0], branch.term[0] + kTerms, out);
    return;
  }
  for (int k = 0; k < kTerms; ++k)
    out[k] = branch.term[0][k] + control_v * (branch.term[1][k] - branch.term[0][k]);
}

/// v = g r(t - To) + F(v(t - To - Tg)); delays as first order in the slopes.
double Board::solve(double r, double rate, const Branch& branch, const double p[kTerms], double start) const {
  double slope = 0.0;
  const double early = r - rate * output_s_;
  if (!wiring_.argument_is_given) {
    const double value = polynomial(p, kTerms, (r - middle_) / half_, slope);
    slope /= half_;
    return value - rate * (output_s_ * slope + branch.delay_s * (slope - reference_gain_));
  }
  // Newton: what is left behind a step is about its square.
  constexpr double kSmallStep = 1e-7;
  double v = start;
  const double late = branch.delay_s + output_s_, by_half = 1.0 / half_;
  for (int i = 0; i < 12; ++i) {
    const double value = polynomial(p, kTerms, (v - middle_) * by_half, slope);
    slope *= by_half;
    const double by_loop = 1.0 / (1.0 - slope);
    const double v_rate = reference_gain_ * rate * by_loop;
    const double step = (reference_gain_ * early + value - slope * v_rate * late - v) * by_loop;
    v = std::clamp(v + step, middle_ - 1.5 * half_, middle_ + 1.5 * half_);
    if (std::abs(step) < kSmallStep) break;
  }
  return v;
}

std::vector<double> Board::drive(const Input& input) const {
  const std::size_t n = input.r.size();
  const std::vector<double> sn = slope_voltage(input);
  std::vector<double> out(n);
  double p[2][kTerms] = {};
  double last_sn = std::nan("");
  bool was_rising = false;
  double v = input.r[0], before = v;
  const double delay = input.switch_delay_s * timing_;
  for (std::size_t k = 0; k < n; ++k) {
    if (sn[k] != last_sn) {
      last_sn = sn[k];
      if (meter_.volts != 0.0) rest_.set_slope(sn[k]);
      for (std::size_t b = 0; b < 2; ++b) mix(branch_[b], rest_.control_v(b), p[b]);
    }
    const bool rising = input.to_turn[k] < delay ? !input.rising[k] : input.rising[k];
    const int b = rising ? 0 : 1;
    const double rate = input.slope[k == 0 ? n - 1 : k - 1];
    // Straight on from the last two.
    const double guess = 2.0 * v - before;
    before = v;
    v = solve(input.r[k], rate, branch_[b], p[b], guess);
    out[k] = v;
    if (k > 0 && rising != was_rising) out[k] += charge_area_ / input.step_s;
    was_rising = rising;
  }
  return out;
}

double Board::at_rest(double r, bool rising, double slope_v) const {
  rest_.set_slope(slope_v);
  double p[kTerms];
  const Branch& b = branch_[rising ? 0 : 1];
  mix(b, rest_.control_v(rising ? 0 : 1), p);
  return solve(r, 0.0, b, p, r);
}

double Board::mean_slope_v(const Input& input) const {
  double sum = 0.0;
  for (const double v : slope_voltage(input)) sum -= v;
  return sum / static_cast<double>(input.r.size());
}

}  // namespace bodesmith::tolerance
