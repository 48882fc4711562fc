#include "fpaa/network/periodic_network.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using NetworkSource = PeriodicNetworks::Source;

constexpr double kTicks = 32e6;

StageSwitches low_pass_stage(int cin, int cint, int cout) {
  StageSwitches s;
  s.capacitors = {switched_branch("Cin", cin, PlateNode::input()),
                  switched_branch("Cout", cout, PlateNode::opamp()),
                  static_branch("Cint", cint, PlateNode::opamp())};
  return s;
}

StageSwitches pole_zero_stage(int ca, int cb, int cc, int cd) {
  StageSwitches s;
  s.capacitors = {static_branch("Cb", cb, PlateNode::input()), switched_branch("Ca", ca, PlateNode::input()),
                  static_branch("Cd", cd, PlateNode::opamp()), switched_branch("Cc", cc, PlateNode::opamp())};
  return s;
}

ClockedNetwork clocked(const StageSwitches& stage, std::int64_t period, bool with_noise = false) {
  return ClockedNetwork(circuit_of(stage), {period}, with_noise);
}

/// Stages one behind the other, each at its clock.
PeriodicNetworks chain(const std::vector<StageSwitches>& stages, const std::vector<std::int64_t>& periods,
                       bool with_noise = false, const SlowParts& slow = {}) {
  PeriodicNetworks out(kTicks);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const NetworkSource from = i == 0 ? NetworkSource{NetworkSource::Kind::board_input, 0}
                                      : NetworkSource{NetworkSource::Kind::network, i - 1};
    out.set_output(out.add(ClockedNetwork(circuit_of(stages[i], slow), {periods[i]}, with_noise), {from}));
  }
  return out;
}

/// The same stages as one network of many clocks: no stage knows that it is one.
PeriodicNetworks joined(const std::vector<StageSwitches>& stages, const std::vector<std::int64_t>& periods,
                        bool with_noise = false, const SlowParts& slow = {}) {
  SwitchedCircuit whole{{}, {"in1"}, "in1", {}, slow.switch_s};
  whole.netlist.opamp = slow.opamp;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    SwitchedCircuit part = circuit_of(stages[i]);
    const std::string number = std::to_string(i), from = whole.output;
    const auto of = [&](const std::string& n) { return n == "0" ? n : n == "in1" ? from : n + "_" + number; };
    for (auto& c : part.netlist.parts) c.from = of(c.from), c.to = of(c.to), whole.netlist.parts.push_back(c);
    for (auto& s : part.netlist.contacts) {
      s.from = of(s.from), s.to = of(s.to), s.control = of(s.control);
      whole.netlist.contacts.push_back(s);
    }
    for (auto& a : part.netlist.opamps)
      a.minus = of(a.minus), a.out = of(a.out), whole.netlist.opamps.push_back(a);
    for (const auto& p : part.phases) whole.phases.push_back({of(p.node), static_cast<int>(i), p.phase});
    whole.output = of("out");
  }
  PeriodicNetworks out(kTicks);
  out.set_output(
      out.add(ClockedNetwork(whole, periods, with_noise), {{NetworkSource::Kind::board_input, 0}}));
  return out;
}

/// A chain of low passes and pole-zero stages at one clock, all in phase 1, in closed form. H from end of phase 1
/// to end of phase 1, D1 and D2 what follows the input at once in phases 1 and 2, A1 = (exp(jwT/2) - 1)/(jwT):
///   Y/U = H sinc(fT) + (D1 + D2)/2 - D1 A1 - D2 conj(A1).
Complex closed_form(const std::vector<StageSwitches>& stages, double period_s, double w) {
  const Complex delay = std::polar(1.0, -w * period_s);
  Complex h = 1.0;
  double d1 = 1.0;
  double d2 = 1.0;
  for (const StageSwitches& s : stages) {
    if (s.capacitors.size() == 3) {
      const double cin = s.capacitors[0].units, cout = s.capacitors[1].units, cint = s.capacitors[2].units;
      h *= -cin / (cout + cint * (1.0 - delay));
      d1 *= -cin / (cout + cint);
      d2 = 0.0;
    } else {
      const double cb = s.capacitors[0].units, ca = s.capacitors[1].units, cd = s.capacitors[2].units,
                   cc = s.capacitors[3].units;
      h *= -(ca + cb * (1.0 - delay)) / (cc + cd * (1.0 - delay));
      d1 *= -(ca + cb) / (cc + cd);
      d2 *= -cb / cd;
    }
  }
  const double half = 0.5 * w * period_s;
  const Complex a1 = (std::polar(1.0, half) - 1.0) / Complex(0.0, w * period_s);
  return h * (std::sin(half) / half) + 0.5 * (d1 + d2) - d1 * a1 - d2 * std::conj(a1);
}

std::vector<StageSwitches> drawn_stages(Random& random, int count) {
  const auto units = [&] { return 1 + static_cast<int>(random.uniform() * 254.0); };
  std::vector<StageSwitches> out;
  for (int i = 0; i < count; ++i) {
    out.push_back(random.uniform() < 0.5 ? low_pass_stage(units(), units(), units())
                                         : pole_zero_stage(units(), units(), units(), units()));
  }
  return out;
}

TEST(PeriodicNetworks, OneClockIsTheClosedForm) {
  Random random(7);
  for (int draw = 0; draw < 60; ++draw) {
    const auto stages = drawn_stages(random, 1 + draw % 8);
    const std::int64_t period = 2 * (1 + static_cast<std::int64_t>(random.uniform() * 20000.0));
    const double period_s = static_cast<double>(period) / kTicks;
    const PeriodicNetworks board = chain(stages, std::vector<std::int64_t>(stages.size(), period));
    for (const double share : {1e-5, 0.01, 0.2, 0.49, 1.3, 4.7}) {
      const double w = 2.0 * std::numbers::pi * share / period_s;
      const Complex wanted = closed_form(stages, period_s, w);
      double scale = std::abs(wanted);
      for (const auto& node : board.nodes({w})) scale = std::max(scale, node[0].largest);
      EXPECT_LT(std::abs(board.gain({w}) - wanted), 1e-12 * scale) << draw << " " << share;
    }
  }
}

TEST(PeriodicNetworks, StagesOfSeveralClocksAreTheWholeNetwork) {
  Random random(11);
  const std::vector<std::vector<std::int64_t>> clocks = {{20, 20, 20}, {20, 60, 20},  {60, 20, 12},
                                                         {28, 20, 28}, {200, 20, 40}, {12, 30, 20},
                                                         {20, 80, 80}, {20, 80, 320}, {20, 240, 100}};
  for (const auto& periods : clocks) {
    const auto stages = drawn_stages(random, 3);
    const PeriodicNetworks one_by_one = chain(stages, periods);
    const PeriodicNetworks whole = joined(stages, periods);
    for (const double hz : {10.0, 5e3, 90e3, 1.7e6}) {
      const RadPerSecond w = Hertz{hz}.rad_s();
      const Complex a = one_by_one.gain(w);
      const Complex b = whole.gain(w);
      EXPECT_LT(std::abs(a - b), 1e-11 * std::max(1.0, std::abs(b)))
          << periods[0] << " " << periods[1] << " " << hz;
      const RadPerSecond line[] = {
          {w.value + 2.0 * std::numbers::pi * kTicks / static_cast<double>(periods[2])}};
      EXPECT_LT(std::abs(one_by_one.components(w, line)[0] - whole.components(w, line)[0]), 1e-11);
      // A network with its noise is solved piece by piece, whatever it follows.
      const auto followed = one_by_one.nodes(w);
      const auto pieces = chain(stages, periods, true).nodes(w);
      for (std::size_t n = 0; n < pieces.size(); ++n)
        EXPECT_NEAR(followed[n][0].largest, pieces[n][0].largest,
                    1e-11 * std::max(1.0, pieces[n][0].largest));
    }
  }
}

/// How late stages are adds up in one network, and from stage to stage but for the second order: a tenth of the time constants leaves
/// a hundredth of the difference.
TEST(PeriodicNetworks, LateStagesAreTheWholeLateNetworkToTheFirstOrder) {
  Random random(13);
  const std::vector<std::vector<std::int64_t>> clocks = {{20, 20, 20},  {20, 60, 20},  {60, 20, 12},
                                                         {28, 20, 28},  {200, 20, 40}, {20, 80, 80},
                                                         {20, 80, 320}, {20, 240, 100}};
  for (const auto& periods : clocks) {
    const auto stages = drawn_stages(random, 3);
    for (const double hz : {10.0, 5e3, 90e3}) {
      const RadPerSecond w = Hertz{hz}.rad_s();
      const auto apart = [&](double late_s) {
        const SlowParts slow{schematic::OpAmpModel::one_pole(RadPerSecond{1.0 / late_s}.hz(), 1e9),
                             0.01 * late_s};
        return std::abs(chain(stages, periods, false, slow).gain(w) -
                        joined(stages, periods, false, slow).gain(w));
      };
      const double late_s = 1e-4 / w.value;
      EXPECT_LT(apart(0.1 * late_s), apart(late_s) / 50.0 + 1e-11)
          << periods[0] << " " << periods[1] << " " << hz;
    }
  }
}

/// A low pass. Phase 2 leaves kT (Cin + Cout) of charge, which is in the virtual ground's from phase 1 on:
///   T sinc(fT) exp(-jwT/2)/(Cout + Cint(1 - 1/z)).
/// In phase 1 the op-amp gives back to Cout what the noise of both branches (R each, i and o) moves:
///   Ci dvi/dt = (ei - vi)/R,   Co dvo/dt = (eo - vo - (Ci vi + Co vo)/Cint)/R,
/// so that with i = Ci/Cint, o = Co/Cint, in kT: Pii = 1/Ci, Pio = -i Pii Ci/(Co + (1 + o) Ci),
/// Poo = (1/Co - i Pio)/(1 + o); the charge Ci vi + Co vo stands on Cint alone for the half period before.
TEST(PeriodicNetworks, NoiseOfALowPassInClosedForm) {
  constexpr double ci = 17.0;
  constexpr double cint = 140.0;
  constexpr double co = 23.0;
  const std::int64_t period = 160;
  PeriodicNetworks board(kTicks);
  board.set_output(
      board.add(clocked(low_pass_stage(17, 140, 23), period, true), {{NetworkSource::Kind::board_input, 0}}));
  const double pio = -(ci / cint) / (co + (1.0 + co / cint) * ci);
  const double poo = (1.0 / co - ci / cint * pio) / (1.0 + co / cint);
  const double variance1 = ci + 2.0 * ci * co * pio + co * co * poo;
  const double period_s = static_cast<double>(period) / kTicks;
  for (const double share : {0.001, 0.1, 0.37, 0.8, 2.2}) {
    const double w = 2.0 * std::numbers::pi * share / period_s;
    const double half = 0.5 * w * period_s;
    const Complex h = 1.0 / (co + cint * (1.0 - std::polar(1.0, -2.0 * half)));
    const Complex of_phase2 = period_s * std::sin(half) / half * std::polar(1.0, -half) * h;
    const Complex of_phase1 = period_s * std::sin(0.5 * half) / half * std::polar(1.0, -0.5 * half) / cint +
                              std::polar(1.0, -half) * of_phase2;
    const double wanted =
        2.0 / period_s * (variance1 * std::norm(of_phase1) + (ci + co) * std::norm(of_phase2));
    EXPECT_NEAR(board.noise_density({w})[0], wanted, 1e-6 * wanted) << share;
  }
}

/// A fast stage's noise folds where a slow one reads it: the whole network, in which every instant is its own, says
/// how much. (There the next stage also samples what the one before it moves within a phase: some percent.)
TEST(PeriodicNetworks, NoiseFoldsAsInTheWholeNetwork) {
  Random random(5);
  for (const auto& periods :
       std::vector<std::vector<std::int64_t>>{{20, 20, 20}, {20, 200, 200}, {200, 20, 40}, {12, 30, 20}}) {
    const auto stages = drawn_stages(random, 3);
    const PeriodicNetworks one_by_one = chain(stages, periods, true);
    const PeriodicNetworks whole = joined(stages, periods, true);
    for (const double hz : {100.0, 30e3, 700e3}) {
      double sum = 0.0;
      for (const double density : one_by_one.noise_density(Hertz{hz}.rad_s())) sum += density;
      const double wanted = whole.noise_density(Hertz{hz}.rad_s())[0];
      EXPECT_NEAR(sum, wanted, 0.12 * wanted) << periods[1] << " " << hz;
    }
  }
}

/// Clocks without a short common period: every part of a sum over its own common period with the sum's clock.
TEST(PeriodicNetworks, PartsOfASumAreSuperposed) {
  const std::int64_t slow = 2 * 8009;  // a prime number of master periods
  const std::int64_t slower = 2 * 10007;
  PeriodicNetworks board(kTicks);
  const NetworkSource pin{NetworkSource::Kind::board_input, 0};
  const std::size_t a = board.add(clocked(low_pass_stage(30, 200, 10), slow), {pin});
  const std::size_t b = board.add(clocked(low_pass_stage(50, 250, 9), slower), {pin});
  StageSwitches sum;
  sum.capacitors = {
      switched_branch("Cin1", 40, PlateNode::input(1)), static_branch("aCin1", 40, PlateNode::input(1)),
      switched_branch("Cin2", 70, PlateNode::input(2)), static_branch("aCin2", 70, PlateNode::input(2)),
      switched_branch("Cout", 90, PlateNode::opamp()),  static_branch("aCout", 90, PlateNode::opamp())};
  board.set_output(
      board.add(clocked(sum, 20), {{NetworkSource::Kind::network, a}, {NetworkSource::Kind::network, b}}));
  EXPECT_LT(board.pieces(), 40000U);
  for (const double hz : {1.0, 40.0, 300.0}) {
    const RadPerSecond w = Hertz{hz}.rad_s();
    const auto nodes = board.nodes(w);
    // A gain stage of equal pairs follows at once.
    const Complex wanted = -(40.0 * nodes[a][0].gain + 70.0 * nodes[b][0].gain) / 90.0;
    EXPECT_LT(std::abs(board.gain(w) - wanted), 1e-4 * std::abs(wanted));
    EXPECT_GE(nodes[2][0].largest, std::abs(board.gain(w)));
  }
}

/// Two inputs that read the board are one of both capacitances, in the gain and in every line.
TEST(PeriodicNetworks, InputsOfOneSourceAddUp) {
  const NetworkSource pin{NetworkSource::Kind::board_input, 0};
  StageSwitches sum = pole_zero_stage(31, 9, 77, 40);
  sum.capacitors.push_back(switched_branch("Cin2", 12, PlateNode::input(2)));
  sum.capacitors.push_back(static_branch("aCin2", 23, PlateNode::input(2)));
  for (const bool behind_another : {false, true}) {
    PeriodicNetworks two(kTicks), one(kTicks);
    NetworkSource from = pin;
    if (behind_another) {
      from = {NetworkSource::Kind::network, two.add(clocked(low_pass_stage(50, 250, 9), 60), {pin})};
      one.add(clocked(low_pass_stage(50, 250, 9), 60), {pin});
    }
    two.set_output(two.add(clocked(sum, 20), {from, from}));
    one.set_output(one.add(clocked(pole_zero_stage(43, 32, 77, 40), 20), {from}));
    for (const double hz : {100.0, 70e3, 3e6}) {
      const RadPerSecond w = Hertz{hz}.rad_s();
      EXPECT_LT(std::abs(two.gain(w) - one.gain(w)), 1e-12);
      const RadPerSecond line[] = {{w.value + 2.0 * std::numbers::pi * kTicks / 20.0}};
      EXPECT_LT(std::abs(two.components(w, line)[0] - one.components(w, line)[0]), 1e-12);
      EXPECT_NEAR(two.nodes(w).back()[0].largest, one.nodes(w).back()[0].largest, 1e-12);
    }
  }
}

/// By Parseval the density over all frequencies is the mean square of the waveform, which the charges' own
/// covariance gives without a frequency: x = M x + noise, half a period each phase.
TEST(PeriodicNetworks, NoiseOverAllFrequenciesIsTheWaveformsMeanSquare) {
  const ClockedNetwork network = clocked(pole_zero_stage(31, 9, 77, 40), 40, true);
  PeriodicNetworks board(kTicks);
  board.set_output(board.add(network, {{NetworkSource::Kind::board_input, 0}}));
  const auto& at = network.intervals();
  double q = 0.0;  // variance of the charge at the beginning of phase 1
  double mean_square = 0.0;
  for (int n = 0; n < 2000; ++n) {
    mean_square = 0.0;
    for (const auto& interval : at) {
      mean_square += 0.5 * interval.c(0, 0) * interval.c(0, 0) * q;
      q = interval.m(0, 0) * interval.m(0, 0) * q + interval.noise(0, 0);
    }
  }
  // Squared sinc tails: the sum to 400 clocks leaves out 1/(pi^2 400) of it at most.
  double sum = 0.0;
  const double clock = kTicks / 40.0;
  const double step = clock / 100.0;
  for (int i = 0; i < 40000; ++i) sum += board.noise_density(Hertz{(i + 0.5) * step}.rad_s())[0] * step;
  EXPECT_NEAR(sum, mean_square, 2e-3 * mean_square);
}

TEST(PeriodicNetworks, AnOpAmpWithoutFeedbackIsRefused) {
  StageSwitches stage = low_pass_stage(10, 20, 30);
  stage.capacitors.pop_back();
  EXPECT_THROW(clocked(stage, 40), std::exception);
}

}  // namespace
}  // namespace bodesmith::fpaa
