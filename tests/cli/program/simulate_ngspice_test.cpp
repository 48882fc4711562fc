// Five chains of different kinds: every engine against ngspice on the same ideal circuit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "chain/registry.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::make_block;
constexpr double kPi = std::numbers::pi;
constexpr double kStep = 2e-5;
constexpr double kStop = 0.04;

TimeRecord triangle() {
  ReferenceSpec spec;
  spec.frequency = Hertz{100.0};
  spec.duration_s = kStop;
  spec.step_s = kStep;
  return make_reference(spec);
}

/// Reference on node n0, 0 to 1, 100 Hz; node b is 1 while it rises.
std::string head() {
  return "chain against ngspice\n.options reltol=1e-6 abstol=1e-15 vntol=1e-10\n"
         "Vx n0 0 PULSE(0 1 0 5e-3 5e-3 1e-12 10e-3)\nVb b 0 PULSE(1 0 5e-3 1e-9 1e-9 5e-3 10e-3)\n";
}

/// x' = rate as current into a unit capacitor.
std::string state(const std::string& name, const std::string& rate) {
  return fmt::format("G{0} 0 {0} VALUE={{{1}}}\nC{0} {0} 0 1 IC=0\nR{0} {0} 0 1e15\n", name, rate);
}

/// Largest difference between a run and ngspice, at ngspice's own times.
double largest_difference(const std::vector<double>& mine, const ngspice::Transient& got) {
  double most = 0.0;
  for (std::size_t i = 0; i < got.time_s.size(); ++i) {
    // Only times near a sample: in between the output is not a straight line.
    const double at = got.time_s[i] / kStep;
    const auto k = static_cast<std::size_t>(at + 0.5);
    if (k + 1 >= mine.size() || k == 0) continue;
    const double s = at - static_cast<double>(k);
    const double value = mine[k] + 0.5 * s * (mine[k + 1] - mine[k - 1]) +
                         0.5 * s * s * (mine[k + 1] - 2.0 * mine[k] + mine[k - 1]);
    const bool corner = k % 250 == 0;
    if (!corner) most = std::max(most, std::abs(value - got.v[0][i]));
  }
  return most;
}

/// Every engine against ngspice, and against the first of them; the figures stand in --gtest_output=xml.
void expect_agreement(const Chain& chain, const std::vector<std::pair<const char*, Engine>>& engines,
                      const std::string& deck, const std::string& node, double limit) {
  const ngspice::Transient got = ngspice::run_transient(deck, {node}, kStep / 4.0, kStop, "test.cir");
  EXPECT_GT(got.time_s.size(), 2000u);
  std::vector<double> first;
  for (const auto& [name, engine] : engines) {
    Options options;
    options.engine = engine;
    options.start = Start::equilibrium;  // ngspice begins at its operating point
    options.relative_tolerance = engine == Engine::cvode ? 1e-12 : 1e-10;  // of a step; of the output
    options.absolute_tolerance = 1e-2 * options.relative_tolerance;
    const auto mine = simulate(chain, triangle(), options).y;
    const double off = largest_difference(mine, got);
    EXPECT_LT(off, limit) << name;
    ::testing::Test::RecordProperty(fmt::format("{}_against_ngspice", name), fmt::format("{:.2g}", off));
    if (first.empty()) first = mine;
    double apart = 0.0;
    for (std::size_t i = 0; i < mine.size(); ++i) apart = std::max(apart, std::abs(mine[i] - first[i]));
    EXPECT_LT(apart, 1e-9) << name;
    ::testing::Test::RecordProperty(fmt::format("{}_against_{}", name, engines.front().first),
                                    fmt::format("{:.2g}", apart));
  }
}

struct SimulateAgainstNgspice : ::testing::Test {
  void SetUp() override {
    if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  }
};

TEST_F(SimulateAgainstNgspice, SwitchedCubicAndSections) {
  Chain chain{{make_block("polynomial_hysteresis")
                   .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                   .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156})}};
  std::string deck = head() +
                     "Eu m0 0 VALUE={V(n0)+(V(b)>0.5 ? V(n0)*(0.3546+V(n0)*(-0.6433+V(n0)*0.2887)) : "
                     "V(n0)*(-0.2398+V(n0)*(0.0838+V(n0)*0.156)))}\n";
  const double zeros[] = {48.79, 107.6, 380.2};
  const double poles[] = {47.49, 126.4, 214.9};
  for (int i = 0; i < 3; ++i) {
    chain.blocks.push_back(make_block("pole_zero")
                               .set("zero_hz", zeros[i] / (2.0 * kPi))
                               .set("pole_hz", poles[i] / (2.0 * kPi)));
    deck += state(fmt::format("s{}", i), fmt::format("{}*(V(m{})-V(s{}))", poles[i], i, i));
    deck +=
        fmt::format("E{0} m{1} 0 VALUE={{V(s{0})+{2}*(V(m{0})-V(s{0}))}}\n", i, i + 1, poles[i] / zeros[i]);
  }
  expect_agreement(chain, {{"exact", Engine::exact}, {"cvode", Engine::cvode}, {"record", Engine::record}},
                   deck, "m3", 1e-4);
}

TEST_F(SimulateAgainstNgspice, LagAndResonance) {
  const Chain chain{{make_block("lowpass").set("corner_hz", 300.0), make_block("resonator")
                                                                        .set("gain", 1.5)
                                                                        .set("natural_frequency_hz", 400.0)
                                                                        .set("damping_ratio", 0.1)}};
  const double p = 2.0 * kPi * 300.0;
  const double w = 2.0 * kPi * 400.0;
  const std::string deck = head() + state("a", fmt::format("{}*(V(n0)-V(a))", p)) +
                           state("y", fmt::format("{}*V(v)", w)) +
                           state("v", fmt::format("{}*(1.5*V(a)-V(y)-0.2*V(v))", w));
  expect_agreement(chain, {{"exact", Engine::exact}, {"cvode", Engine::cvode}}, deck, "y", 1e-4);
}

TEST_F(SimulateAgainstNgspice, CubicSpring) {
  const Chain chain{{make_block("resonator")
                         .set("natural_frequency_hz", 250.0)
                         .set("damping_ratio", 0.1)
                         .set("cubic", 1.5)}};
  const double w = 2.0 * kPi * 250.0;
  const std::string deck = head() + state("y", fmt::format("{}*V(v)", w)) +
                           state("v", fmt::format("{}*(V(n0)-V(y)-0.2*V(v)-1.5*V(y)*V(y)*V(y))", w));
  expect_agreement(chain, {{"automatic", Engine::automatic}, {"cvode", Engine::cvode}}, deck, "y", 1e-4);
}

TEST_F(SimulateAgainstNgspice, SaturationBetweenLags) {
  const Chain chain{{make_block("lowpass").set("corner_hz", 300.0),
                     make_block("saturation").set("lower", 0.2).set("upper", 0.7),
                     make_block("lowpass").set("corner_hz", 200.0)}};
  const std::string deck =
      head() + state("a", fmt::format("{}*(V(n0)-V(a))", 2.0 * kPi * 300.0)) +
      state("y", fmt::format("{}*((V(a)<0.2 ? 0.2 : (V(a)>0.7 ? 0.7 : V(a)))-V(y))", 2.0 * kPi * 200.0));
  expect_agreement(chain, {{"automatic", Engine::automatic}, {"cvode", Engine::cvode}}, deck, "y", 1e-4);
}

TEST_F(SimulateAgainstNgspice, OpampThatSlews) {
  // Slower than the triangle's 200 V/s.
  const Chain chain{{make_block("opamp")
                         .set("gain", 1.0)
                         .set("gain_bandwidth_hz", 2000.0)
                         .set("slew_rate_v_per_s", 150.0)}};
  const std::string deck =
      head() + state("y", fmt::format("150*tanh({}*(V(n0)-V(y))/150)", 2.0 * kPi * 2000.0));
  expect_agreement(chain, {{"automatic", Engine::automatic}, {"cvode", Engine::cvode}}, deck, "y", 2e-4);
}

}  // namespace
}  // namespace bodesmith::simulate
