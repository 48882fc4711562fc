// The search's closed form against charges counted step by step, and its derivatives against differences.
#include "fpaa/search/sine_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "fpaa/search/fit.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using Stage = DesignStage;

/// Every op-amp of a design in small steps of time under the input exp(jwt): at each step the charge that its capacitors' near plates
/// bring to the virtual ground stays what it was, and what a switch has discharged brings none.
class SteppedDesign {
 public:
  SteppedDesign(const Design& design, double master_hz, double hz)
      : design_(design),
        master_hz_(master_hz),
        w_(2.0 * M_PI * hz),
        y_(design.stages.size()),
        a_(y_),
        held_(y_.size()) {}

  /// The pin's component at the sine's own frequency, over `periods` of the slowest clock after `settle` of them.
  Complex run(int settle, int periods, int steps_a_half) {
    std::int64_t slowest = 1;
    std::int64_t fastest = std::int64_t{1} << 40;
    for (const Stage& s : design_.stages) {
      slowest = std::max(slowest, s.divisor);
      fastest = std::min(fastest, s.divisor);
    }
    const double dt = 0.5 * static_cast<double>(fastest) / master_hz_ / steps_a_half;
    const auto steps = static_cast<long>(steps_a_half * 2 * (slowest / fastest));
    Complex sum = 0.0;
    double t = 0.0;
    for (long n = 0; n < steps * (settle + periods); ++n) {
      // The step ends at t + dt, within one phase of every clock.
      const long half_of_fastest = n / steps_a_half;
      const Complex start = step(t, half_of_fastest, fastest);  // right after a switch: nothing has moved
      const Complex end = step(t + dt, half_of_fastest, fastest);
      if (n >= steps * settle) {
        sum += 0.5 * dt * (start * std::polar(1.0, -w_ * t) + end * std::polar(1.0, -w_ * (t + dt)));
      }
      t += dt;
    }
    return sum / (dt * static_cast<double>(steps) * periods);
  }

 private:
  struct Source {
    Complex now, carried;
  };
  struct State {
    std::vector<Complex> charge;
  };

  Complex step(double t, long half_of_fastest, std::int64_t fastest) {
    const Complex u = std::polar(1.0, w_ * t);
    const std::vector<Complex> was = y_;
    for (std::size_t s = 0; s < design_.stages.size(); ++s) {
      const Stage& stage = design_.stages[s];
      const bool first_phase = (half_of_fastest / (stage.divisor / fastest)) % 2 == 0;
      std::vector<Source> in;
      for (const int from : stage.from) {
        if (from < 0) {
          in.push_back({u, u_});
        } else {
          in.push_back({y_[static_cast<std::size_t>(from)], was[static_cast<std::size_t>(from)]});
        }
      }
      stage.is_first() ? first_order(s, first_phase, in) : second_order(s, first_phase, in[0]);
    }
    u_ = u;
    return y_.back();
  }

  void first_order(std::size_t s, bool first_phase, const std::vector<Source>& in) {
    const std::vector<double>& c = design_.stages[s].c;
    const std::size_t n = 2 * in.size();
    State& q = held_[s];
    q.charge.resize(n + 2);
    // A switched capacitor that comes back has been discharged; static ones carry their voltage.
    if (!first_phase) std::fill(q.charge.begin(), q.charge.end(), Complex(0.0));
    Complex sum = c[n + 1] * y_[s];
    double below = c[n + 1];
    for (std::size_t i = 0; i < in.size(); ++i) sum -= c[2 * i + 1] * (in[i].now - in[i].carried);
    if (first_phase) {
      for (std::size_t i = 0; i < in.size(); ++i) {
        sum -= c[2 * i] * in[i].now - q.charge[2 * i];
      }
      sum += q.charge[n];
      below += c[n];
    }
    y_[s] = sum / below;
    if (!first_phase) return;
    for (std::size_t i = 0; i < in.size(); ++i) q.charge[2 * i] = c[2 * i] * in[i].now;
    q.charge[n] = c[n] * y_[s];
  }

  void second_order(std::size_t s, bool first_phase, const Source& in) {
    const Stage& stage = design_.stages[s];
    const std::vector<double>& c = stage.c;
    const bool high = stage.kind == Stage::Kind::second_high;
    State& q = held_[s];
    q.charge.resize(5);
    Complex& c1 = q.charge[0];
    Complex& c2 = q.charge[1];
    Complex& c3 = q.charge[2];
    Complex& c4 = q.charge[3];
    Complex& cp = q.charge[4];
    const Complex move = in.now - in.carried;
    const Complex y_before = y_[s];
    // Second op-amp.
    Complex sum = c[Stage::kCB] * y_[s] - c[Stage::kCpp] * move;
    double below = c[Stage::kCB];
    if (first_phase) {
      sum += c3;  // what C3 took up in phase 2
      c3 = 0.0;
      if (!high) {
        sum += c4 + cp - c[Stage::kCp] * in.now;
        below += c[Stage::kC4];
      }
    }
    y_[s] = sum / below;
    // First op-amp.
    Complex first = c[Stage::kCA] * a_[s];
    if (high) first -= c[Stage::kCp] * move + c[Stage::kC4] * (y_[s] - y_before);
    if (first_phase) {
      first -= c[Stage::kC2] * y_[s] - c2;
      c2 = c[Stage::kC2] * y_[s];
      if (stage.c1_inverting) first -= c[Stage::kC1] * in.now - c1;
      c1 = c[Stage::kC1] * in.now;
      if (!high) {
        c4 = c[Stage::kC4] * y_[s];
        cp = c[Stage::kCp] * in.now;
      }
    } else {
      c2 = c4 = cp = 0.0;
      if (!stage.c1_inverting) first += c1;
      c1 = 0.0;
    }
    a_[s] = first / c[Stage::kCA];
    if (!first_phase) c3 = c[Stage::kC3] * a_[s];
  }

  const Design& design_;
  double master_hz_, w_;
  Complex u_ = 1.0;
  std::vector<Complex> y_, a_;
  std::vector<State> held_;
};

DesignTarget target_at(std::vector<double> hz) {
  DesignTarget out;
  out.master_hz = 1e6;
  out.band = {{hz.front()}, {hz.back()}};
  for (const double f : hz) {
    out.grid.push_back(Hertz{f}.rad_s());
    out.wanted.emplace_back(1.0);
    out.weight.push_back(1.0);
    out.reciprocal.push_back(1.0);
  }
  return out;
}

Stage stage_of(Stage::Kind kind, std::int64_t divisor, std::vector<int> from, std::vector<double> c) {
  Stage out;
  out.kind = kind;
  out.divisor = divisor;
  out.from = std::move(from);
  out.c = std::move(c);
  return out;
}

/// One of everything: a low pass, a biquad of either quality with all inputs, a sum over a stage and the input, pole-zero stages, at
/// three clocks.
Design mixed_design() {
  using Kind = Stage::Kind;
  Design out;
  out.stages = {stage_of(Kind::first, 10, {-1}, {20, 0, 20, 60}),
                stage_of(Kind::second_low, 10, {0}, {30, 20, 60, 40, 70, 60, 200, 180}),
                stage_of(Kind::second_high, 20, {1}, {30, 40, 50, 40, 70, 90, 200, 180}),
                stage_of(Kind::first, 20, {2, 1}, {50, 20, 70, 90, 100, 50}),
                stage_of(Kind::first, 80, {3}, {40, 120, 50, 160})};
  out.stages[1].c1_inverting = false;
  return out;
}

TEST(SineResponse, IsWhatTheChargesDo) {
  const Design design = mixed_design();
  const std::vector<double> hz{300.0, 1700.0, 5300.0, 11000.0};
  const DesignTarget target = target_at(hz);
  const StageFactorTable table(target);
  const DesignResponse response(design, table);
  for (std::size_t k = 0; k < hz.size(); ++k) {
    const Complex stepped = SteppedDesign(design, target.master_hz, hz[k]).run(40, 1, 400);
    EXPECT_NEAR(std::abs(response.output(k) - stepped), 0.0, 1e-4 * std::abs(stepped) + 1e-5) << hz[k];
  }
}

/// Y/U = H sinc(fT) + (D1 + D2)/2 - D1 A1 - D2 A1*, A1 = (exp(jwT/2) - 1)/(jwT): chains of pole-zero stages and low passes at one clock.
TEST(SineResponse, OneClockInClosedForm) {
  Design design;
  design.stages = {stage_of(Stage::Kind::first, 500, {-1}, {7, 93, 5, 121}),
                   stage_of(Stage::Kind::first, 500, {0}, {9, 210, 11, 180})};
  const DesignTarget target = target_at({3.0, 90.0, 700.0, 1900.0});
  const StageFactorTable table(target);
  const DesignResponse response(design, table);
  const double period = 500.0 / target.master_hz;
  for (std::size_t k = 0; k < target.grid.size(); ++k) {
    const double turn = target.grid[k].value * period;
    const Complex d = 1.0 - std::polar(1.0, -turn);
    const Complex h = (7.0 + 93.0 * d) / (5.0 + 121.0 * d) * (9.0 + 210.0 * d) / (11.0 + 180.0 * d);
    const double d1 = 100.0 / 126.0 * 219.0 / 191.0;
    const double d2 = 93.0 / 121.0 * 210.0 / 180.0;
    const Complex a1 = (std::polar(1.0, 0.5 * turn) - 1.0) / Complex(0.0, turn);
    const Complex wanted =
        h * std::sin(0.5 * turn) / (0.5 * turn) + 0.5 * (d1 + d2) - d1 * a1 - d2 * std::conj(a1);
    EXPECT_NEAR(std::abs(response.output(k) - wanted), 0.0, 1e-12);
  }
}

TEST(SineResponse, OneStageInItsPlaceIsExact) {
  const Design design = mixed_design();
  const DesignTarget target = target_at({300.0, 1700.0, 5300.0});
  const StageFactorTable table(target);
  const DesignResponse response(design, table);
  const std::vector<Complex> errors = response.errors();
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    Design other = design;
    for (double& c : other.stages[s].c) c = c > 0.0 ? 1.1 * c + 3.0 : 0.0;
    const std::vector<Complex> wanted = DesignResponse(other, table).errors();
    const StagePlace place(response, response.ways(), s);
    std::vector<Complex> share;
    std::vector<Complex> changed;
    place.share_of(design.stages[s], share);
    place.share_of(other.stages[s], changed);
    for (std::size_t k = 0; k < share.size(); ++k) {
      EXPECT_NEAR(std::abs(errors[k] + changed[k] - share[k] - wanted[k]), 0.0, 1e-12) << s;
    }
  }
}

TEST(SineResponse, EffectsAreDerivatives) {
  const Design design = mixed_design();
  const DesignTarget target = target_at({300.0, 1700.0, 5300.0});
  const StageFactorTable table(target);
  const DesignResponse response(design, table);
  const CapacitorEffects effects = capacitor_effects(response);
  for (const CapacitorEffect& effect : effects.list) {
    Design other = design;
    constexpr double kStep = 1e-6;
    other.stages[effect.stage].c[effect.capacitor] *= std::exp(kStep);
    const DesignResponse moved(other, table);
    for (std::size_t k = 0; k < target.grid.size(); ++k) {
      const Complex wanted = (moved.output(k) - response.output(k)) / kStep;
      EXPECT_NEAR(std::abs(effect.values[k] - wanted), 0.0, 1e-4) << effect.stage << " " << effect.capacitor;
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
