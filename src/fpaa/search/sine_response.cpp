#include "fpaa/search/sine_response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using Stage = DesignStage;

/// Without the care for overflow that the operator takes.
inline Complex inverse(Complex of) {
  const double by = 1.0 / (of.real() * of.real() + of.imag() * of.imag());
  return {of.real() * by, -of.imag() * by};
}
inline Complex quotient(Complex above, Complex below) {
  return product(above, inverse(below));
}

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

  Complex below(const ClockFactors& at) const {
    return cb * at.d + c4s + (k * c4f) * at.period + (k * c2) * at.sum;
  }

  double c1i, e, cpf, cps, cpp, c2, c4f, c4s, ca, cb, k, g;
};

}  // namespace

const std::vector<ClockFactors>& StageFactorTable::clock(std::int64_t divisor) const {
  for (const Kept& entry : kept_) {
    if (entry.divisor == divisor) return entry.values;
  }
  kept_.push_back({divisor, {}});
  std::vector<ClockFactors>& out = kept_.back().values;
  for (const RadPerSecond w : target_.grid) {
    const double turn = w.value * static_cast<double>(divisor) / target_.master_hz;  // wT
    ClockFactors f;
    f.half = std::polar(1.0, -0.5 * turn);
    f.period = std::polar(1.0, -turn);
    f.d = 2.0 * std::abs(std::sin(0.5 * turn)) *
          std::polar(1.0, std::copysign(0.5 * std::numbers::pi, std::sin(0.5 * turn)) - 0.5 * turn);
    f.sum = quotient(f.period, f.d);
    // (1/T) int_0^{T/2} exp(jw tau) dtau = sin(wT/4)/(wT/4) exp(jwT/4)/2
    const double quarter = 0.25 * turn;
    f.hold = 0.5 * (quarter < 1e-9 ? 1.0 : std::sin(quarter) / quarter) * std::polar(1.0, quarter);
    out.push_back(f);
  }
  return out;
}

StageEquations::StageEquations(const Stage& stage, std::size_t input) : first_(stage.is_first()) {
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

StageFactors StageEquations::at(const ClockFactors& clock) const {
  if (first_) return {-quotient(c0_ + c1_ * clock.d, d0_ + d1_ * clock.d), 0.0, follow1_, follow2_};
  const Complex by = inverse(of_d_ * clock.d + of_one_ + of_period_ * clock.period + of_sum_ * clock.sum);
  return {product(above_one_ + above_period_ * clock.period + above_sum_ * clock.sum, by),
          product(above_half_ * clock.half, by), follow1_, follow2_};
}

namespace {

SineParts after_stage(const StageFactors& f, const ClockFactors& k, const SineParts& x) {
  SineParts y;
  y.end1 = product(f.from1, x.end1) + product(f.from2, x.end2);
  y.end2 = product(k.half, y.end1) + f.follow2 * (product(k.half, x.end1) - x.end2);
  y.mean1 = product(y.end1 + f.follow1 * x.end1, k.hold) - f.follow1 * x.mean1;
  y.mean2 = product(y.end2 + f.follow2 * x.end2, k.hold) - f.follow2 * x.mean2;
  return y;
}

void add(SineParts& to, const SineParts& by) {
  to.end1 += by.end1;
  to.end2 += by.end2;
  to.mean1 += by.mean1;
  to.mean2 += by.mean2;
}

constexpr SineParts kNothing{0.0, 0.0, 0.0, 0.0};

/// d pin / d end1 of a stage's output where the ways of its four parts are `way`.
Complex way_of_end2(const SineParts& way, const ClockFactors& k) {
  return way.end2 + product(k.hold, way.mean2);
}
Complex way_of_end1(const SineParts& way, const ClockFactors& k) {
  return way.end1 + product(k.half, way_of_end2(way, k)) + product(k.hold, way.mean1);
}

}  // namespace

/// Both equations of the first op-amp together, with y2 = h y1 + g (h x1 - x2):
///   CA d a2 = (h e - C4f g h d) x1 + (C4f g - Cpf) d x2 - (C4f d + C2) h y1
FirstOpAmp first_opamp(const Stage& stage, const ClockFactors& k, const SineParts& x) {
  const SecondOrder s(stage);
  const StageFactors own = StageEquations(stage, 0).at(k);
  const Complex y1 = product(own.from1, x.end1) + product(own.from2, x.end2);
  const Complex y2 = product(k.half, y1) + own.follow2 * (product(k.half, x.end1) - x.end2);
  const Complex late = product(k.d, k.half);
  const Complex charge = product(k.half * s.e - late * (s.c4f * s.g), x.end1) +
                         product(k.d * (s.c4f * s.g - s.cpf), x.end2) -
                         product(late * s.c4f + k.half * s.c2, y1);
  const Complex a2 = quotient(charge, s.ca * k.d);
  const Complex a1 =
      product(k.half, a2) +
      (product(k.half, s.cpf * x.end2 + s.c4f * y2) - (s.c1i + s.cpf) * x.end1 - (s.c2 + s.c4f) * y1) / s.ca;
  return {a1, a2};
}

SineParts charge_response(const Stage& stage, int opamp, const ClockFactors& k) {
  Complex end1;
  if (stage.is_first()) {
    const std::size_t n = 2 * stage.from.size();
    end1 = inverse(stage.c[n] + stage.c[n + 1] * k.d);
  } else {
    const SecondOrder s(stage);
    end1 = opamp == 2 ? inverse(s.below(k)) : quotient(s.k * k.sum, s.below(k));
  }
  return after_stage({end1, 0.0, 0.0, 0.0}, k, {});
}

DesignResponse::DesignResponse(const Design& design, const StageFactorTable& table)
    : design_(design), table_(table), signals_(design.stages.size()) {
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    const Stage& stage = design.stages[s];
    const std::vector<ClockFactors>& clock = table.clock(stage.divisor);
    std::vector<SineParts>& out = signals_[s];
    out.assign(points(), kNothing);
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      const StageEquations equations(stage, i);
      for (std::size_t k = 0; k < out.size(); ++k)
        add(out[k], after_stage(equations.at(clock[k]), clock[k], input_of(s, i, k)));
    }
  }
}

SineParts DesignResponse::input_of(std::size_t stage, std::size_t input, std::size_t k) const {
  const Stage& reader = design_.stages[stage];
  const int from = reader.from[input];
  if (from == Stage::kBoardInput) return {};
  const auto source = static_cast<std::size_t>(from);
  const SineParts& x = signals_[source][k];
  return design_.stages[source].divisor == reader.divisor ? x : x.read_slower();
}

std::vector<Complex> DesignResponse::errors() const {
  const DesignTarget& target = table_.target();
  std::vector<Complex> out(points());
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = target.weight[k] * target.reciprocal[k] * (output(k) - target.wanted[k]);
  }
  return out;
}

std::vector<std::vector<SineParts>> DesignResponse::ways() const {
  std::vector<std::vector<SineParts>> out(design_.stages.size(), std::vector<SineParts>(points(), kNothing));
  for (SineParts& way : out.back()) way = {0.0, 0.0, 1.0, 1.0};
  for (std::size_t s = design_.stages.size(); s-- > 0;) {
    const Stage& stage = design_.stages[s];
    const std::vector<ClockFactors>& clock = table_.clock(stage.divisor);
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      if (stage.from[i] == Stage::kBoardInput) continue;
      const auto source = static_cast<std::size_t>(stage.from[i]);
      const bool same = design_.stages[source].divisor == stage.divisor;
      const StageEquations equations(stage, i);
      for (std::size_t k = 0; k < points(); ++k) {
        const StageFactors f = equations.at(clock[k]);
        const SineParts& way = out[s][k];
        const Complex end2 = way_of_end2(way, clock[k]);
        const Complex end1 = way_of_end1(way, clock[k]);
        SineParts x;
        x.end1 = product(f.from1, end1) + f.follow2 * product(clock[k].half, end2) +
                 f.follow1 * product(clock[k].hold, way.mean1);
        x.end2 = product(f.from2, end1) - f.follow2 * end2 + f.follow2 * product(clock[k].hold, way.mean2);
        x.mean1 = -f.follow1 * way.mean1;
        x.mean2 = -f.follow2 * way.mean2;
        if (!same) {
          x = {0.0, x.end1 + x.end2, 0.5 * (x.mean1 + x.mean2), 0.5 * (x.mean1 + x.mean2)};
        }
        add(out[source][k], x);
      }
    }
  }
  return out;
}

StagePlace::StagePlace(const DesignResponse& response, const std::vector<SineParts>& ways, std::size_t s)
    : clock_(response.table().clock(response.design().stages[s].divisor)), errors_(response.errors()) {
  const Stage& stage = response.design().stages[s];
  const DesignTarget& target = response.table().target();
  for (std::size_t i = 0; i < stage.from.size(); ++i) {
    std::vector<Weights> list(response.points());
    for (std::size_t k = 0; k < list.size(); ++k) {
      const double scale = target.weight[k] * target.reciprocal[k];
      const SineParts x = response.input_of(s, i, k);
      const ClockFactors& clock = clock_[k];
      const Complex end2 = way_of_end2(ways[k], clock);
      const Complex end1 = way_of_end1(ways[k], clock);
      Weights& w = list[k];
      w.from1 = scale * product(end1, x.end1);
      w.from2 = scale * product(end1, x.end2);
      w.follow1 = scale * product(ways[k].mean1, product(x.end1, clock.hold) - x.mean1);
      w.follow2 = scale * (product(end2, product(clock.half, x.end1) - x.end2) +
                           product(ways[k].mean2, product(x.end2, clock.hold) - x.mean2));
    }
    weights_.push_back(std::move(list));
  }
  share_of(stage, share_);
}

std::vector<std::vector<Complex>> StagePlace::slopes(const Stage& stage) const {
  if (!stage.is_first()) return second_order_slopes(stage);
  const auto& c = stage.c;
  const std::size_t n = 2 * stage.from.size();
  std::vector<std::vector<Complex>> out(c.size(), std::vector<Complex>(errors_.size(), 0.0));
  const double both = c[n] + c[n + 1];
  for (std::size_t k = 0; k < errors_.size(); ++k) {
    const Complex d = clock_[k].d;
    const Complex inv = inverse(c[n] + c[n + 1] * d);
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      const Weights& w = weights_[i][k];
      const StageFactors f{-product(c[2 * i] + c[2 * i + 1] * d, inv), 0.0, (c[2 * i] + c[2 * i + 1]) / both,
                           c[n + 1] > 0.0 ? c[2 * i + 1] / c[n + 1] : 0.0};
      const Complex in = product(w.from1, inv);
      const Complex back = product(w.from1, product(f.from1, inv));
      out[2 * i][k] = c[2 * i] * (w.follow1 / both - in);
      out[2 * i + 1][k] = c[2 * i + 1] * (w.follow1 / both - product(in, d));
      out[n][k] -= c[n] * (back + w.follow1 * (f.follow1 / both));
      out[n + 1][k] -= c[n + 1] * (product(back, d) + w.follow1 * (f.follow1 / both));
      if (!(c[n + 1] > 0.0)) continue;
      out[2 * i + 1][k] += f.follow2 * w.follow2;
      out[n + 1][k] -= f.follow2 * w.follow2;
    }
  }
  return out;
}

/// Each is a quotient `above`/below of sums of products of capacitors: (d above - quotient d below)/below.
std::vector<std::vector<Complex>> StagePlace::second_order_slopes(const Stage& stage) const {
  const SecondOrder s(stage);
  const StageEquations equations(stage, 0);
  std::vector<std::vector<Complex>> out(stage.c.size(), std::vector<Complex>(errors_.size()));
  const double both = s.cb + s.c4s;
  for (std::size_t k = 0; k < errors_.size(); ++k) {
    const ClockFactors& at = clock_[k];
    const Weights& w = weights_[0][k];
    const StageFactors f = equations.at(at);
    const Complex by = inverse(s.below(at));
    const Complex above1 = product(w.from1, by);
    const Complex above2 = product(w.from2, by);
    const Complex below = -product(product(w.from1, f.from1) + product(w.from2, f.from2), by);
    // What C4 and Cpp make together at high Q.
    const Complex both_static = (s.k * s.c4f * s.g) * (product(above2, at.half) - product(above1, at.period));
    const Complex loop = (s.k * s.c2) * product(below, at.sum);
    const Complex damping = (s.k * s.c4f) * product(below, at.period);
    const Complex through_c1 = (s.k * s.e) * product(above1, at.sum);
    const Complex through_cpf = (-s.k * s.cpf) * product(above2, at.half);
    const Complex c3 = loop + damping + through_c1 + through_cpf + both_static;
    out[Stage::kC1][k] = through_c1;
    out[Stage::kCp][k] = through_cpf + s.cps * (w.follow1 / both - above1);
    out[Stage::kCpp][k] =
        s.cpp * (product(above1, at.period - 1.0) + w.follow1 / both) + both_static + s.g * w.follow2;
    out[Stage::kC2][k] = loop;
    out[Stage::kC3][k] = c3;
    out[Stage::kC4][k] = damping + both_static + s.c4s * (below - w.follow1 * (f.follow1 / both));
    out[Stage::kCA][k] = -c3;
    out[Stage::kCB][k] =
        s.cb * (product(below, at.d) - w.follow1 * (f.follow1 / both)) - both_static - s.g * w.follow2;
  }
  return out;
}

void StagePlace::share_of(const Stage& stage, std::vector<Complex>& out) const {
  out.assign(errors_.size(), 0.0);
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const bool second = !stage.is_first();
    const StageEquations equations(stage, i);
    for (std::size_t k = 0; k < out.size(); ++k) {
      const StageFactors f = equations.at(clock_[k]);
      const Weights& w = weights_[i][k];
      out[k] += product(w.from1, f.from1) + f.follow1 * w.follow1 + f.follow2 * w.follow2;
      if (second) out[k] += product(w.from2, f.from2);
    }
  }
}

double StagePlace::largest_error_with(const Stage& stage, std::vector<Complex>& room) const {
  share_of(stage, room);
  double out = 0.0;
  for (std::size_t k = 0; k < room.size(); ++k) {
    const double squared = std::norm(errors_[k] + room[k] - share_[k]);
    // Not std::max: a NaN has to come out as the worst.
    if (!(squared <= out)) out = std::isnan(squared) ? 1e300 : squared;
  }
  return std::sqrt(out);
}

double largest_error(const std::vector<Complex>& errors) {
  double out = 0.0;
  for (const Complex& e : errors) {
    const double squared = std::norm(e);
    if (!(squared <= out)) out = std::isnan(squared) ? 1e300 : squared;
  }
  return std::sqrt(out);
}

}  // namespace bodesmith::fpaa
