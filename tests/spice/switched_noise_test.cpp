#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fpaa/network/clocked_network.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::spice {
namespace {

constexpr double kPeriod = 40e-9;
constexpr double kNoiseStep = 0.4e-9;  ///< a fifth of a branch's time constant
constexpr double kThermal = 1e-14;     ///< kT, J: so that noise is tenths of a volt
constexpr double kOnSiemens = 1e-3;

/// A circuit with noisy switches as ngspice runs it: each a conductance in its phase, with the white current of
/// intensity 2 kT g beside it.
class NoisyDeck {
 public:
  NoisyDeck() {
    for (int phase = 1; phase <= 2; ++phase) {
      text_ += fmt::format("Vp{0} p{0} 0 PULSE(0 1 {1:.6g} 0.2n 0.2n {2:.6g} {3:.6g})\n", phase,
                           phase == 1 ? 0.0 : 0.5 * kPeriod, 0.5 * kPeriod - 1.4e-9, kPeriod);
    }
  }
  void add_switch(const std::string& a, const std::string& b, int phase) {
    ++switches_;
    const double current = std::sqrt(2.0 * kThermal * kOnSiemens / kNoiseStep);
    text_ += fmt::format(
        "GS{0} {1} {2} VALUE={{V({1},{2})*V(p{3})*{4}}}\nRS{0} {1} {2} 1e12\n"
        "Vn{0} z{0} 0 DC 0 TRNOISE(1 {5} 0 0)\nBN{0} {1} {2} I=V(z{0})*V(p{3})*{6:.9g}\n",
        switches_, a, b, phase, kOnSiemens, kNoiseStep, current);
  }
  void add_branch(const std::string& name, const std::string& from, const char* farad) {
    add_switch(from, "u" + name, 1);
    add_switch("u" + name, "0", 2);
    add_switch("w" + name, "n", 1);
    add_switch("w" + name, "0", 2);
    text_ += fmt::format("C{0} u{0} w{0} {1}\n", name, farad);
  }
  std::string text() const {
    return "noise\n" + text_ +
           "Cint out n 2p\nCY n 0 1f\nEop out 0 0 n 1e6\n"
           ".options method=gear reltol=1e-3 abstol=1e-12 vntol=1e-6 chgtol=1e-15 seed=7\n";
  }

 private:
  std::string text_;
  int switches_ = 0;
};

/// A low pass of 1 pF branches on 2 pF, its input at ground: what stands on Cint through phase 2.
TEST(SwitchedNoise, ALowPassInNgspice) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  constexpr int kPeriods = 1500;
  NoisyDeck deck;
  deck.add_branch("a", "0", "1p");
  deck.add_branch("b", "out", "1p");
  const Transient run = run_transient(deck.text(), {"out"}, kNoiseStep, kPeriods * kPeriod, "noise");
  std::vector<double> held;
  for (int n = 20; n + 1 < kPeriods; ++n) {
    const auto at = std::upper_bound(run.time_s.begin(), run.time_s.end(), (n + 0.9) * kPeriod);
    held.push_back(run.v[0][static_cast<std::size_t>(at - run.time_s.begin())]);
  }
  double mean = 0.0;
  for (const double v : held) mean += v / static_cast<double>(held.size());
  double square = 0.0;
  for (const double v : held) square += (v - mean) * (v - mean) / static_cast<double>(held.size());

  fpaa::StageSwitches stage;
  using fpaa::PlateNode;
  stage.capacitors = {fpaa::switched_branch("Cin", 1, PlateNode::input()),
                      fpaa::switched_branch("Cout", 1, PlateNode::opamp()),
                      fpaa::static_branch("Cint", 2, PlateNode::opamp())};
  const double units[] = {1.0, 1.0, 2.0};  // pF
  const fpaa::ClockedNetwork network(fpaa::network_of(stage, units), {2}, true);
  const auto& phases = network.intervals();
  double charge = 0.0;  // variance at the beginning of phase 2
  double wanted = 0.0;
  for (int n = 0; n < 200; ++n) {
    wanted = phases[1].c(0, 0) * phases[1].c(0, 0) * charge;
    for (const std::size_t p : {1U, 0U})
      charge = phases[p].m(0, 0) * phases[p].m(0, 0) * charge + phases[p].noise(0, 0);
  }
  wanted *= kThermal / 1e-12;
  // Neighbours correlate by two thirds: some 570 free values, 0.25 dB of chance. The simulator's own steps, a fifth of the
  // branches' time constants, take half a decibel and more off. (2 kT C a branch and sample, as books have it, would be
  // 1.1 dB above `wanted`, and so 2.1 dB above what is found here.)
  const double off_db = 10.0 * std::log10(square / wanted);
  EXPECT_LT(off_db, 0.7);
  EXPECT_GT(off_db, -1.5);
}

}  // namespace
}  // namespace bodesmith::spice
