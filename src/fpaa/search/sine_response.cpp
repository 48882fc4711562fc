#include "fpaa/search/sine_response.hpp"

#include <cmath>
#include <numbers>

#include "numeric/sinc.hpp"

namespace bodesmith::fpaa {
namespace {

using Stage = DesignStage;
using Clock = ClockFactors;
using Factors = StageFactors;
using Signal = Parts;

/// Charge conservation in a second-order stage, its capacitors by what they do. With h = exp(-jwT/2), (x1, x2) the input, (a1, a2) the
/// first op-amp and (y1, y2) the second at the ends of the phases:
///   phase 1:  (CB + C4s) y1 = h (CB y2 + C3 a2 + Cpp x2) - (Cps + Cpp) x1
///             CA a1 = h (CA a2 + Cpf x2 + C4f y2) - (C1i + Cpf) x1 - (C2 + C4f) y1
///   phase 2:  CA a2 = h (CA a1 + (Cpf + C1n) x1 + C4f y1) - Cpf x2 - C4f y2
///             CB y2 = h (CB y1 + Cpp x1) - Cpp x2
/// C4 and Cp are switched into the second op-amp at low Q (C4s, Cps), static into the first at high Q (C4f,
/// Cpf); C1 inverts (C1i) or is taken in phase 1 and given in phase 2 (C1n). With d = 1 - h^2, s = h^2/d (ClockFactors::sum),
/// e = C1n - C1i, g = Cpp/CB, k = C3/CA the op-amp voltages go out of it:
///   y1 (CB d + C4s + k (C4f h^2 + C2 s)) = (Cpp (h^2 - 1) - Cps + k (e s - C4f g h^2)) x1 + k (C4f g - Cpf) h x2
struct SecondOrder {
  explicit SecondOrder(const Stage& stage) {
    const bool high = stage.kind == Stage::Kind::second_high;
    const auto& c = stage.c;
    c1i = stage.c1_inverting ? c[Stage::kC1] : 0.0;
    e = stage.c1_inverting ? -c[Stage::kC1] : c[Stage::kC1];
    cpf = high ? c[Stage::kCp] : 0.0;
    cps = high ? 0.0 : c[Stage::kCp];
    cpp = c[Stage::kCpp];
    c2 = c[Stage::kC2];
    c4f = high ? c[Stage::kC4] : 0.0;
    c4s = high ? 0.0 : c[Stage::kC4];
    ca = c[Stage::kCA];
    cb = c[Stage::kCB];
    k = c[Stage::kC3] / ca;
    g = cpp / cb;
  }

  ComplexPair below(const Clock& at) const {
    return cb * at.d + c4s + (k * c4f) * at.period + (k * c2) * at.sum;
  }

  double c1i, e, cpf, cps, cpp, c2, c4f, c4s, ca, cb, k, g;
};

/// A stage's charge equations with its capacitors put in, for one input.
class StageEquations {
 public:
  StageEquations(const Stage& stage, std::size_t input) : first_(stage.is_first()) {
    const auto& c = stage.c;
    if (first_) {
      const std::size_t n = 2 * stage.from.size();
      c0_ = c[2 * input];
      c1_ = c[2 * input + 1];
      d0_ = c[n];
      d1_ = c[n + 1];
      follow1_ = (c0_ + c1_) / (d0_ + d1_);
      follow2_ = d1_ > 0.0 ? c1_ / d1_ : 0.0;
      return;
    }
    const SecondOrder s(stage);
    of_d_ = s.cb;
    of_one_ = s.c4s;
    of_period_ = s.k * s.c4f;
    of_sum_ = s.k * s.c2;
    above_one_ = -s.cpp - s.cps;
    above_period_ = s.cpp - s.k * s.c4f * s.g;
    above_sum_ = s.k * s.e;
    above_half_ = s.k * (s.c4f * s.g - s.cpf);
    follow1_ = (s.cps + s.cpp) / (s.cb + s.c4s);
    follow2_ = s.g;
  }

  Factors at(const Clock& clock) const {
    if (first_) return {-quotient(c0_ + c1_ * clock.d, d0_ + d1_ * clock.d), 0.0, follow1_, follow2_};
    const ComplexPair by =
        inverse(of_d_ * clock.d + of_one_ + of_period_ * clock.period + of_sum_ * clock.sum);
    return {product(above_one_ + above_period_ * clock.period + above_sum_ * clock.sum, by),
            product(above_half_ * clock.half, by), follow1_, follow2_};
  }

 private:
  bool first_;
  double c0_ = 0.0, c1_ = 0.0, d0_ = 0.0, d1_ = 0.0;  ///< first order: -(c0 + c1 D)/(d0 + d1 D)
  /// Second order: coefficients of what the clock makes, see SecondOrder.
  double of_d_ = 0.0, of_one_ = 0.0, of_period_ = 0.0, of_sum_ = 0.0;
  double above_one_ = 0.0, above_period_ = 0.0, above_sum_ = 0.0, above_half_ = 0.0;
  double follow1_ = 0.0, follow2_ = 0.0;
};

Signal after_stage(const Factors& f, const Clock& k, const Signal& x) {
  Signal y;
  y.end1 = product(f.from1, x.end1) + product(f.from2, x.end2);
  y.end2 = product(k.half, y.end1) + f.follow2 * (product(k.half, x.end1) - x.end2);
  y.mean1 = product(y.end1 + f.follow1 * x.end1, k.hold) - f.follow1 * x.mean1;
  y.mean2 = product(y.end2 + f.follow2 * x.end2, k.hold) - f.follow2 * x.mean2;
  return y;
}

void add(Signal& to, const Signal& by) {
  to.end1 += by.end1;
  to.end2 += by.end2;
  to.mean1 += by.mean1;
  to.mean2 += by.mean2;
}

const Signal kNothing{0.0, 0.0, 0.0, 0.0};

/// d pin / d end1 of a stage's output where the ways of its four parts are `way`.
ComplexPair way_of_end2(const Signal& way, const Clock& k) {
  return way.end2 + product(k.hold, way.mean2);
}
ComplexPair way_of_end1(const Signal& way, const Clock& k) {
  return way.end1 + product(k.half, way_of_end2(way, k)) + product(k.hold, way.mean1);
}

/// At two points, by what the period turns there, wT.
Clock factors_at(double first, double second) {
  const auto at = [&](auto factor) { return ComplexPair(factor(first), factor(second)); };
  Clock f;
  f.half = at([](double turn) { return std::polar(1.0, -0.5 * turn); });
  f.period = at([](double turn) { return std::polar(1.0, -turn); });
  f.d = at([](double turn) {
    return 2.0 * std::abs(std::sin(0.5 * turn)) *
           std::polar(1.0, std::copysign(0.5 * std::numbers::pi, std::sin(0.5 * turn)) - 0.5 * turn);
  });
  f.sum = quotient(f.period, f.d);
  // (1/T) int_0^{T/2} exp(jw tau) dtau = sin(wT/4)/(wT/4) exp(jwT/4)/2
  f.hold = at([](double turn) {
    const double quarter = 0.25 * turn;
    return 0.5 * sinc(quarter) * std::polar(1.0, quarter);
  });
  return f;
}

}  // namespace

const std::vector<Clock>& StageFactorTable::clock(std::int64_t divisor) const {
  for (const Kept& entry : kept_) {
    if (entry.divisor == divisor) return entry.values;
  }
  kept_.push_back({divisor, {}});
  std::vector<Clock>& out = kept_.back().values;
  out.reserve(pairs());
  const double per_hz = static_cast<double>(divisor);
  const auto turn = [&](std::size_t k) {
    return target_.grid[std::min(k, points() - 1)].value * per_hz / target_.master_hz;
  };
  for (std::size_t k = 0; k < points(); k += 2) out.push_back(factors_at(turn(k), turn(k + 1)));
  return out;
}

/// Both equations of the first op-amp together, with y2 = h y1 + g (h x1 - x2):
///   CA d a2 = (h e - C4f g h d) x1 + (C4f g - Cpf) d x2 - (C4f d + C2) h y1
FirstOpAmp first_opamp(const Stage& stage, const Clock& k, const Signal& x) {
  const SecondOrder s(stage);
  const Factors own = StageEquations(stage, 0).at(k);
  const ComplexPair y1 = product(own.from1, x.end1) + product(own.from2, x.end2);
  const ComplexPair y2 = product(k.half, y1) + own.follow2 * (product(k.half, x.end1) - x.end2);
  const ComplexPair late = product(k.d, k.half);
  const ComplexPair charge = product(s.e * k.half - (s.c4f * s.g) * late, x.end1) +
                             product((s.c4f * s.g - s.cpf) * k.d, x.end2) -
                             product(s.c4f * late + s.c2 * k.half, y1);
  const ComplexPair a2 = quotient(charge, s.ca * k.d);
  const ComplexPair a1 =
      product(k.half, a2) +
      (product(k.half, s.cpf * x.end2 + s.c4f * y2) - (s.c1i + s.cpf) * x.end1 - (s.c2 + s.c4f) * y1) / s.ca;
  return {a1, a2};
}

Signal charge_response(const Stage& stage, int opamp, const Clock& k) {
  ComplexPair end1;
  if (stage.is_first()) {
    const std::size_t n = 2 * stage.from.size();
    end1 = inverse(stage.c[n] + stage.c[n + 1] * k.d);
  } else {
    const SecondOrder s(stage);
    end1 = opamp == 2 ? inverse(s.below(k)) : quotient(s.k * k.sum, s.below(k));
  }
  return after_stage({end1, 0.0}, k, Signal::of_input());
}

DesignResponse::DesignResponse(const Design& design, const StageFactorTable& table)
    : design_(design), table_(table), signals_(design.stages.size() * table.pairs()) {
  const std::size_t pairs = table.pairs();
  std::size_t inputs = 0;
  for (const Stage& stage : design.stages) {
    first_input_.push_back(inputs);
    inputs += stage.from.size();
  }
  factors_.resize(inputs * pairs);
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    const Stage& stage = design.stages[s];
    const std::vector<Clock>& clock = table.clock(stage.divisor);
    Signal* const out = &signals_[s * pairs];
    std::fill(out, out + pairs, kNothing);
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      const StageEquations equations(stage, i);
      Factors* const factors = &factors_[(first_input_[s] + i) * pairs];
      for (std::size_t k = 0; k < pairs; ++k) {
        factors[k] = equations.at(clock[k]);
        add(out[k], after_stage(factors[k], clock[k], input_of(s, i, k)));
      }
    }
  }
}

std::vector<Complex> DesignResponse::errors() const {
  const DesignTarget& target = table_.target();
  std::vector<Complex> out(table_.points());
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = target.weight[k] * target.reciprocal[k] * (output(k) - target.wanted[k]);
  }
  return out;
}

std::vector<Signal> DesignResponse::ways() const {
  const std::size_t pairs = table_.pairs();
  std::vector<Signal> out(design_.stages.size() * pairs, kNothing);
  std::fill(out.end() - static_cast<std::ptrdiff_t>(pairs), out.end(), Signal{0.0, 0.0, 1.0, 1.0});
  for (std::size_t s = design_.stages.size(); s-- > 0;) {
    const Stage& stage = design_.stages[s];
    const std::vector<Clock>& clock = table_.clock(stage.divisor);
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      if (stage.from[i] == Stage::kBoardInput) continue;
      const auto source = static_cast<std::size_t>(stage.from[i]);
      const bool same = design_.stages[source].divisor == stage.divisor;
      for (std::size_t k = 0; k < pairs; ++k) {
        const Factors& f = factors(s, i, k);
        const Signal& way = out[s * pairs + k];
        const ComplexPair end2 = way_of_end2(way, clock[k]);
        const ComplexPair end1 = way_of_end1(way, clock[k]);
        Signal x;
        x.end1 = product(f.from1, end1) + f.follow2 * product(clock[k].half, end2) +
                 f.follow1 * product(clock[k].hold, way.mean1);
        x.end2 = product(f.from2, end1) - f.follow2 * end2 + f.follow2 * product(clock[k].hold, way.mean2);
        x.mean1 = -f.follow1 * way.mean1;
        x.mean2 = -f.follow2 * way.mean2;
        if (!same) {
          const ComplexPair half = 0.5 * (x.mean1 + x.mean2);
          x = {0.0, x.end1 + x.end2, half, half};
        }
        add(out[source * pairs + k], x);
      }
    }
  }
  return out;
}

StagePlace::StagePlace(const DesignResponse& response, const std::vector<Signal>& ways, std::size_t s)
    : clock_(response.table().clock(response.design().stages[s].divisor)),
      points_(response.table().points()) {
  const Stage& stage = response.design().stages[s];
  const DesignTarget& target = response.table().target();
  const auto scale_at = [&](std::size_t point) {
    return point < points_ ? target.weight[point] * target.reciprocal[point] : 0.0;
  };
  weights_.reserve(stage.from.size() * clock_.size());
  for (std::size_t i = 0; i < stage.from.size(); ++i) {
    for (std::size_t k = 0; k < clock_.size(); ++k) {
      const Pair scale{scale_at(2 * k), scale_at(2 * k + 1)};
      const auto scaled = [&](const ComplexPair& of) { return ComplexPair{scale * of.re, scale * of.im}; };
      const Signal x = response.input_of(s, i, k);
      const Clock& clock = clock_[k];
      const Signal& way = ways[s * clock_.size() + k];
      const ComplexPair end2 = way_of_end2(way, clock);
      const ComplexPair end1 = way_of_end1(way, clock);
      weights_.push_back({scaled(product(end1, x.end1)), scaled(product(end1, x.end2)),
                          scaled(product(way.mean1, product(x.end1, clock.hold) - x.mean1)),
                          scaled(product(end2, product(clock.half, x.end1) - x.end2) +
                                 product(way.mean2, product(x.end2, clock.hold) - x.mean2))});
    }
  }
}

void StagePlace::slopes(const Stage& stage, Complex* const out) const {
  std::vector<ComplexPair> at(stage.c.size());
  for (std::size_t k = 0; k < clock_.size(); ++k) {
    stage.is_first() ? first_order_slopes(stage, k, at.data()) : second_order_slopes(stage, k, at.data());
    for (std::size_t c = 0; c < at.size(); ++c) {
      out[c * points_ + 2 * k] = at[c].at(0);
      if (2 * k + 1 < points_) out[c * points_ + 2 * k + 1] = at[c].at(1);
    }
  }
}

void StagePlace::first_order_slopes(const Stage& stage, std::size_t k, ComplexPair* const out) const {
  const auto& c = stage.c;
  const std::size_t n = 2 * stage.from.size();
  const double both = c[n] + c[n + 1];
  const ComplexPair& d = clock_[k].d;
  const ComplexPair inv = inverse(c[n] + c[n + 1] * d);
  out[n] = out[n + 1] = 0.0;
  for (std::size_t i = 0; i < stage.from.size(); ++i) {
    const Weights& w = weights_[i * clock_.size() + k];
    const Factors f{-product(c[2 * i] + c[2 * i + 1] * d, inv), 0.0, (c[2 * i] + c[2 * i + 1]) / both,
                    c[n + 1] > 0.0 ? c[2 * i + 1] / c[n + 1] : 0.0};
    const ComplexPair in = product(w.from1, inv);
    const ComplexPair back = product(w.from1, product(f.from1, inv));
    const ComplexPair follow = w.follow1 / both;
    const ComplexPair followed = (f.follow1 / both) * w.follow1;
    out[2 * i] = c[2 * i] * (follow - in);
    out[2 * i + 1] = c[2 * i + 1] * (follow - product(in, d));
    out[n] -= c[n] * (back + followed);
    out[n + 1] -= c[n + 1] * (product(back, d) + followed);
    if (!(c[n + 1] > 0.0)) continue;
    out[2 * i + 1] += f.follow2 * w.follow2;
    out[n + 1] -= f.follow2 * w.follow2;
  }
}

/// Each is a quotient `above`/below of sums of products of capacitors: (d above - quotient d below)/below.
void StagePlace::second_order_slopes(const Stage& stage, std::size_t k, ComplexPair* const out) const {
  const SecondOrder s(stage);
  const double both = s.cb + s.c4s;
  const Clock& at = clock_[k];
  const Weights& w = weights_[k];
  const Factors f = StageEquations(stage, 0).at(at);
  const ComplexPair by = inverse(s.below(at));
  const ComplexPair above1 = product(w.from1, by);
  const ComplexPair above2 = product(w.from2, by);
  const ComplexPair below = -product(product(w.from1, f.from1) + product(w.from2, f.from2), by);
  const ComplexPair follow = w.follow1 / both;
  const ComplexPair followed = (f.follow1 / both) * w.follow1;
  // What C4 and Cpp make together at high Q.
  const ComplexPair both_static =
      (s.k * s.c4f * s.g) * (product(above2, at.half) - product(above1, at.period));
  const ComplexPair loop = (s.k * s.c2) * product(below, at.sum);
  const ComplexPair damping = (s.k * s.c4f) * product(below, at.period);
  const ComplexPair through_c1 = (s.k * s.e) * product(above1, at.sum);
  const ComplexPair through_cpf = (-s.k * s.cpf) * product(above2, at.half);
  const ComplexPair c3 = loop + damping + through_c1 + through_cpf + both_static;
  out[Stage::kC1] = through_c1;
  out[Stage::kCp] = through_cpf + s.cps * (follow - above1);
  out[Stage::kCpp] = s.cpp * (product(above1, at.period - 1.0) + follow) + both_static + s.g * w.follow2;
  out[Stage::kC2] = loop;
  out[Stage::kC3] = c3;
  out[Stage::kC4] = damping + both_static + s.c4s * (below - followed);
  out[Stage::kCA] = -c3;
  out[Stage::kCB] = s.cb * (product(below, at.d) - followed) - both_static - s.g * w.follow2;
}

void StagePlace::share_of(const Stage& stage, std::vector<Complex>& out) const {
  out.assign(points_, 0.0);
  const bool second = !stage.is_first();
  for (std::size_t i = 0; i < stage.from.size(); ++i) {
    const StageEquations equations(stage, i);
    for (std::size_t k = 0; k < clock_.size(); ++k) {
      const Factors f = equations.at(clock_[k]);
      const Weights& w = weights_[i * clock_.size() + k];
      ComplexPair sum = product(w.from1, f.from1) + f.follow1 * w.follow1 + f.follow2 * w.follow2;
      if (second) sum += product(w.from2, f.from2);
      out[2 * k] += sum.at(0);
      if (2 * k + 1 < points_) out[2 * k + 1] += sum.at(1);
    }
  }
}

double largest_error(const std::vector<Complex>& errors) {
  double out = 0.0;
  for (const Complex& e : errors) {
    const double squared = std::norm(e);
    // Not std::max: a NaN has to come out as the worst.
    if (!(squared <= out)) out = std::isnan(squared) ? 1e300 : squared;
  }
  return std::sqrt(out);
}

}  // namespace bodesmith::fpaa
