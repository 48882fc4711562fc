#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fpaa/network/switched_netlist.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/seed_sections.hpp"
#include "fpaa/sheets/board_netlist.hpp"
#include "fpaa/stage_samples.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using fpaa::NetlistParts;
using fpaa::PlacedCam;
using fpaa::Plan;

constexpr int kTones = 10;

/// Samples of an input that is held from just before each period on: tones of whole turns in `window` periods,
/// those of every `inputs`-th number from `first` on.
std::vector<double> tone_samples(int count, int window, std::size_t first, std::size_t inputs,
                                 const std::vector<int>& turns) {
  std::vector<double> out(static_cast<std::size_t>(count), 0.0);
  for (std::size_t k = first; k < turns.size(); k += inputs) {
    for (std::size_t n = 0; n < out.size(); ++n) {
      const double angle = 2.0 * std::numbers::pi * turns[k] * static_cast<double>(n) / window;
      out[n] += 0.1 * std::cos(angle + static_cast<double>(k * k));
    }
  }
  return out;
}

std::string staircase(const std::string& name, const std::string& node, const std::vector<double>& samples,
                      double period, double gap) {
  std::string out = fmt::format("V{} {} 0 PWL(0 {:.12g}", name, node, samples[0]);
  for (std::size_t n = 1; n < samples.size(); ++n) {
    const double at = static_cast<double>(n) * period;
    out += fmt::format("\n+ {:.12g} {:.12g} {:.12g} {:.12g}", at - 0.4 * gap * period, samples[n - 1],
                       at - 0.1 * gap * period, samples[n]);
  }
  return out + ")\n";
}

Complex turn_of(const std::vector<double>& samples, std::size_t from, int window, int turns) {
  Complex out = 0.0;
  for (int n = 0; n < window; ++n) {
    out += samples[from + static_cast<std::size_t>(n)] *
           std::polar(1.0, -2.0 * std::numbers::pi * turns * (static_cast<double>(from) + n) / window);
  }
  return out;
}

/// Straight between the points that ngspice chose.
double at_time(const ngspice::Transient& run, double time) {
  const auto next = std::upper_bound(run.time_s.begin(), run.time_s.end(), time);
  const auto i = static_cast<std::size_t>(next - run.time_s.begin());
  if (i == 0 || i >= run.time_s.size()) return run.v[0].back();
  const double share = (time - run.time_s[i - 1]) / (run.time_s[i] - run.time_s[i - 1]);
  return run.v[0][i - 1] + share * (run.v[0][i] - run.v[0][i - 1]);
}

/// Of a run, in periods of the fastest clock.
struct RunLength {
  int settle = 45;
  int window = 40;
  int steps = 8;  ///< ngspice's longest, in a period
  /// Whole turns in the window, each a tone.
  std::vector<int> turns{1, 2, 3, 4, 5, 7, 9, 12, 15, 18};
};

/// H from input to output, at each of the tones, by ngspice: the tones' fundamentals by least squares over
/// whole turns, at the end of each output phase.
struct Measured {
  std::vector<int> turns;
  std::vector<Complex> h;
};
Measured run_stage(const std::string& library, const std::string& call, std::size_t inputs, double period,
                   double gap, double read_at, const RunLength& length = {}) {
  Measured out;
  out.turns = length.turns;
  const int count = length.settle + length.window;
  std::string deck = "board\n" + library;
  std::vector<std::vector<double>> x;
  for (std::size_t i = 0; i < inputs; ++i) {
    x.push_back(tone_samples(count, length.window, i, inputs, out.turns));
    deck += staircase(fmt::format("in{}", i + 1), fmt::format("in{}", i + 1), x.back(), period, gap);
  }
  // What is read at the end of a phase is charge, which Euler's backward rule keeps whatever its steps.
  deck += call + ".options maxord=1 trtol=10000\n" + fpaa::board_deck_options() + "\n";
  const ngspice::Transient run =
      ngspice::run_transient(deck, {"out"}, period / length.steps, count * period, "board.sub");
  std::vector<double> y;
  for (int n = 0; n < count; ++n) y.push_back(at_time(run, (n + read_at) * period));
  const auto from = static_cast<std::size_t>(length.settle);
  for (std::size_t k = 0; k < out.turns.size(); ++k) {
    out.h.push_back(turn_of(y, from, length.window, out.turns[k]) /
                    turn_of(x[k % inputs], from, length.window, out.turns[k]));
  }
  return out;
}

Plan plan_of_one(const PlacedCam& cam) {
  Plan plan;
  plan.board = "an231k04-quad4";
  plan.chips = {{1, {16e6}, {}, {cam}}};
  plan.wires = {{"chip1." + cam.name, "chip1.out1"}};
  for (std::size_t i = 1; i <= cam.input_count(); ++i) {
    plan.wires.push_back({fmt::format("chip1.in{}", i), "chip1." + cam.name, static_cast<int>(i)});
  }
  return plan;
}

/// Parts that are ideal at this clock, and quick to compute.
NetlistParts ideal_parts(double clock) {
  NetlistParts parts;
  parts.gap = 0.01;
  parts.switch_on_ohm = 1.0 / (300.0 * clock * 500.0 * parts.unit_capacitance_f);
  parts.switch_off_ohm = 1e6 / (clock * parts.unit_capacitance_f);
  return parts;
}

schematic::OpAmpModel quick_opamp(double clock) {
  return schematic::OpAmpModel::one_pole({60.0 * clock}, 1e7);
}

/// A stage by itself: its subcircuit and phases out of the plan's netlist, each input a node of the deck.
Measured measured_stage(const PlacedCam& cam, const NetlistParts& parts, double read_at, int steps = 8) {
  Plan plan = plan_of_one(cam);
  plan.slow.opamp = quick_opamp(cam.clock_a.value);
  std::string library = fpaa::board_netlist(plan, parts, "stage");
  // All wires lead to the one input pin "in": give each input a node of its own.
  std::string pins;
  std::string shared;
  for (std::size_t i = 1; i <= cam.input_count(); ++i) {
    pins += fmt::format("in{} ", i);
    shared += "in ";
  }
  const auto replace = [&](const std::string& what, const std::string& with) {
    const std::size_t at = library.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    library.replace(at, what.size(), with);
  };
  // With its line ends: the heading comment says the same words.
  replace("\n.subckt board in out\n", "\n.subckt board " + pins + "out\n");
  replace("Xchip1_Stage1 " + shared, "Xchip1_Stage1 " + pins);
  const RunLength length{.settle = cam.cam->switches(cam)->opamps.size() > 1 ? 90 : 45, .steps = steps};
  return run_stage(library, "Xb " + pins + "out board\n", cam.input_count(), 1.0 / cam.clock_a.value,
                   parts.gap, read_at, length);
}

double error_db(Complex got, Complex wanted) {
  return std::abs(20.0 * std::log10(std::abs(got / wanted)));
}

/// The end of the phase in which the output is valid, as a share of the period.
double read_at_of(const PlacedCam& cam, const NetlistParts& parts) {
  const auto stage = cam.cam->switches(cam);
  return (stage->output_phase == 2 ? 1.0 : 0.5) - 0.8 * parts.gap;
}

Complex wanted_of(const fpaa::StageSample& sample, std::size_t input, RadPerSecond w) {
  const Complex late = std::polar(1.0, -w.value / sample.cam.clock_a.value * sample.late_periods[input]);
  return sample.cam.z.response(w, sample.cam.clock_a, input + 1) * late;
}

/// With one or two op-amps, so that two tests can run side by side.
void expect_equations(std::size_t opamps) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  for (const fpaa::StageSample& sample : fpaa::stage_samples()) {
    if (sample.cam.cam->switches(sample.cam)->opamps.size() != opamps) continue;
    const NetlistParts parts = ideal_parts(sample.cam.clock_a.value);
    const Measured got = measured_stage(sample.cam, parts, read_at_of(sample.cam, parts));
    ASSERT_EQ(got.h.size(), static_cast<std::size_t>(kTones));
    for (std::size_t k = 0; k < got.h.size(); ++k) {
      const RadPerSecond w{2.0 * std::numbers::pi * got.turns[k] / 40.0 * sample.cam.clock_a.value};
      const Complex wanted = wanted_of(sample, k % sample.cam.input_count(), w);
      EXPECT_LT(error_db(got.h[k], wanted), 0.01) << sample.title << " at " << w.hz().value << " Hz";
      EXPECT_LT(std::abs(got.h[k] / wanted - 1.0), 1e-3) << sample.title << " at " << w.hz().value << " Hz";
    }
  }
}

TEST(Board, EveryStageIsItsEquationInNgspice) {
  expect_equations(1);
}

TEST(Board, EveryStageOfTwoOpAmpsIsItsEquationInNgspice) {
  expect_equations(2);
}

/// A stage of stage_samples() under another name and clock.
PlacedCam sample_stage(const std::string& title, const std::string& name, double clock) {
  for (fpaa::StageSample& sample : fpaa::stage_samples()) {
    if (sample.title != title) continue;
    sample.cam.name = name;
    sample.cam.clock_a = {clock};
    return sample.cam;
  }
  throw std::logic_error("no stage " + title);
}

/// Component of a run's output at a frequency over its last `window` seconds, straight between ngspice's points.
Complex component_of(const ngspice::Transient& run, double from_s, double window_s, double hz) {
  Complex out = 0.0;
  const double w = 2.0 * std::numbers::pi * hz;
  const auto turned = [&](double t) { return at_time(run, t) * std::polar(1.0, -w * t); };
  const auto add = [&](double a, double b) { out += 0.5 * (b - a) * (turned(a) + turned(b)); };
  double last = from_s;
  for (const double t : run.time_s) {
    if (t <= from_s || t >= from_s + window_s) continue;
    add(last, t);
    last = t;
  }
  add(last, from_s + window_s);
  return 2.0 * out / window_s;
}

/// Sines that move at the input pin, the whole waveform at the output pin: the component at each sine's own frequency
/// by ngspice against the charges'. The window is whole common periods of the clocks.
void expect_waveform(Plan plan, double clock, const RunLength& length) {
  NetlistParts parts = ideal_parts(clock);
  plan.slow = {quick_opamp(clock), parts.switch_on_ohm * parts.unit_capacitance_f};
  parts.gap = 0.002;
  const double period = 1.0 / clock;
  std::string deck = "board\n" + fpaa::board_netlist(plan, parts, "plan");
  std::string above = "in1";
  for (std::size_t k = 0; k < length.turns.size(); ++k) {
    const std::string below = k + 1 == length.turns.size() ? "0" : fmt::format("tone{}", k);
    deck += fmt::format("Vtone{} {} {} SIN(0 0.1 {:.12g})\n", k, above, below,
                        length.turns[k] / (length.window * period));
    above = below;
  }
  deck += "Xb in1 out board\n" + fpaa::board_deck_options() + "\n";
  const double stop = (length.settle + length.window) * period;
  const ngspice::Transient run =
      ngspice::run_transient(deck, {"out"}, period / length.steps, stop, "board.sub");
  const fpaa::SwitchedBoard board(plan);
  std::vector<Complex> ratio;
  std::vector<double> angular;
  for (const int turns : length.turns) {
    const double hz = turns / (length.window * period);
    // A sine is cos delayed by a quarter turn.
    const Complex got =
        component_of(run, length.settle * period, length.window * period, hz) / (Complex(0.0, -1.0) * 0.1);
    ratio.push_back(got / board.gain(Hertz{hz}.rad_s()));
    angular.push_back(2.0 * std::numbers::pi * hz);
  }
  // To the first order in how late op-amps and switches are, some hundredths of a period together.
  for (std::size_t k = 0; k < ratio.size(); ++k) EXPECT_LT(std::abs(ratio[k] - 1.0), 3e-3) << angular[k];
}

TEST(Board, AWholeCascadeAsItsSwitchesMakeIt) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  constexpr double kClock = 100e3;
  Plan plan;
  plan.board = "an231k04-quad4";
  plan.chips = {{1,
                 {16e6},
                 {},
                 {sample_stage("FilterBilinear Pole and Zero", "Section1", kClock),
                  sample_stage("FilterBilinear Low Pass", "Section2", kClock)}},
                {2,
                 {16e6},
                 {},
                 {sample_stage("FilterBilinear High Pass", "Section3", kClock),
                  sample_stage("GainInv ", "Gain4", kClock)}}};
  plan.wires = {{"chip1.in1", "chip1.Section1"},  {"chip1.Section1", "chip1.Section2"},
                {"chip1.Section2", "chip1.out1"}, {"chip1.out1", "chip2.in1"},
                {"chip2.in1", "chip2.Section3"},  {"chip2.Section3", "chip2.Gain4"},
                {"chip2.Gain4", "chip2.out1"}};
  expect_waveform(plan, kClock, {.settle = 60, .steps = 48});
}

/// Partial fractions: a constant path and a low pass of a slower clock, summed at the fast one.
TEST(Board, AParallelPlanOfTwoClocksAsItsSwitchesMakeIt) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  constexpr double kClock = 100e3;
  Plan plan;
  plan.board = "an231k04-quad4";
  plan.chips = {{1,
                 {16e6},
                 {},
                 {sample_stage("FilterBilinear Low Pass", "Path1", kClock / 4.0),
                  sample_stage("SumInv 2 inputs", "Sum1", kClock)}}};
  plan.wires = {{"chip1.in1", "chip1.Path1"},
                {"chip1.in1", "chip1.Sum1", 1},
                {"chip1.Path1", "chip1.Sum1", 2},
                {"chip1.Sum1", "chip1.out1"}};
  // The slow clock turns 20 times in the window: no tone, nor its mirror image, may fold onto another.
  expect_waveform(plan, kClock,
                  {.settle = 140, .window = 80, .steps = 48, .turns = {1, 2, 5, 7, 9, 12, 17, 24, 34}});
}

/// The file as `sc` reads it, one network of all CAMs and their strays: what the plan's own networks make, whose op-amps take no
/// strays, but for the second order in how late they are one behind the other.
TEST(Board, TheNetlistReadBackIsTheBoard) {
  for (const double slow : {100e3, 25e3}) {
    Plan plan = plan_of_one(sample_stage("FilterBilinear Pole and Zero", "Section1", 100e3));
    plan.chips[0].cams.push_back(sample_stage("FilterBilinear Low Pass", "Section2", slow));
    plan.wires = {{"chip1.in1", "chip1.Section1"},
                  {"chip1.Section1", "chip1.Section2"},
                  {"chip1.Section2", "chip1.out1"}};
    plan.slow = SlowParts::typical();
    const std::string text = board_netlist(plan, {}, "plan");
    EXPECT_EQ(schematic::spice_text(schematic::read_spice(text, "board.sub")), text);
    const PeriodicNetworks whole = SwitchedNetlist::read(text, "board.sub").networks();
    const SwitchedBoard board(plan);
    for (const double hz : {10.0, 300.0, 2e3, 9e3, 40e3}) {
      const Complex wanted = board.gain(Hertz{hz}.rad_s());
      constexpr double kLate = 50e-9;
      EXPECT_LT(std::abs(whole.gain(Hertz{hz}.rad_s()) / wanted - 1.0),
                1e-9 + std::pow(kLate * Hertz{hz}.rad_s().value, 2))
          << hz;
    }
  }
}

TEST(Board, APlanWithSwitchesThatAreNotKnownIsRefusedInOneLine) {
  PlacedCam cam;
  cam.name = "Look1";
  cam.cam = fpaa::cam_registry().find("TransferFunction");
  cam.clock_a = {100e3};
  try {
    fpaa::board_netlist(plan_of_one(cam), {}, "plan");
    ADD_FAILURE();
  } catch (const DesignError& error) {
    const std::string refused = error.what();
    EXPECT_NE(refused.find("chip1.Look1"), std::string::npos);
    EXPECT_EQ(refused.find('\n'), std::string::npos);
  }
}

// Five periods of the middle of the band, or as many as 10 000 of the fastest clock are, steps an eighth of it.
TEST(BoardDeck, RunsAsLongAsTheFastestClockAllows) {
  Plan plan = seed_plan();
  const double middle = std::sqrt(plan.error.band.from.value * plan.error.band.to.value);
  const auto runs = [](const Plan& of, double hz, double clock_hz, double stop_s) {
    const std::string deck = board_deck(of, "deck");
    const auto text = [](double number) { return schematic::plain_number(number); };
    EXPECT_NE(deck.find(" V at " + text(hz) + " Hz through"), std::string::npos) << deck;
    EXPECT_NE(deck.find("tran " + text(0.125 / clock_hz) + " " + text(stop_s) + " 0 "), std::string::npos)
        << deck;
  };
  runs(plan, middle, 2000.0, 5.0 / middle);
  // At 100 kHz five periods are of 50 Hz, which lies within the band; at 1 MHz of its upper end one and a half are left.
  const auto at_clock = [&](double hz) {
    for (ChipPlan& chip : plan.chips) {
      for (PlacedCam& cam : chip.cams) cam.clock_a = Hertz{hz};
    }
    return plan;
  };
  runs(at_clock(100e3), 50.0, 100e3, 0.1);
  const double top = plan.error.band.to.value;
  runs(at_clock(1e6), top, 1e6, 1.5 / top);
}

}  // namespace
}  // namespace bodesmith::fpaa
