#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>

#include "base/error.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::schematic {
namespace {

using Complex = std::complex<double>;
using testing::HasSubstr;

Netlist read(const std::string& text, const std::string& file = "my.cir") {
  const SpiceLibrary library = read_spice(text, file);
  return library.two_port(library.top);
}

std::string refusal(const std::string& text, const std::string& file = "my.cir") {
  try {
    read(text, file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

constexpr const char* kDeck = R"(A Sallen-Key, as people write it
.param r2 = 12k c={cc}  ; the second is another's
.param cc=10n
* the input
V1 IN gnd DC 0 AC 1
Vcc vcc 0 15
Vee vee 0 DC -15
r1	in A	10K
R2 a b {R2}
C1 a OUT 22nF
C2 b gnd
+ {c}
XU1 b out vcc vee out Ideal
.ac dec 10 10 100k
.control
run
.endc
.end
what stands behind the end
)";

/// Its equation with an op-amp of gain A: 1/(1 + s C2 (R1 + R2) + s^2 R1 R2 C1 C2) where A is infinite.
Complex sallen_key(Hertz f, double gain) {
  const double r1 = 10e3, r2 = 12e3, c1 = 22e-9, c2 = 10e-9;
  const Complex s(0.0, f.rad_s().value);
  const double k = 1.0 / (1.0 + 1.0 / gain);
  return k / (1.0 + s * (c2 * (r1 + r2) + r1 * c1 * (1.0 - k)) + s * s * (r1 * r2 * c1 * c2));
}

TEST(SpiceReader, ADeckAsPeopleWriteItIsItsEquation) {
  const Netlist netlist = read(kDeck);
  EXPECT_EQ(netlist.parts.size(), 4u);
  EXPECT_TRUE(netlist.opamp.is_ideal);
  for (const double hz : {10.0, 700.0, 5e3, 1e5}) {
    const Complex h = network_response(netlist, {Hertz{hz}})[0], wanted = sallen_key(Hertz{hz}, 1e300);
    EXPECT_LT(std::abs(h - wanted), 1e-9 * std::abs(wanted)) << hz;
  }
}

TEST(SpiceReader, AControlledSourceIsAnAmplifierOfItsGain) {
  for (const char* out : {"E1 out 0 b out 200", "e1 OUT GND out b -200"}) {
    const Netlist netlist =
        read(std::string(".subckt f in out\nR1 in a 10k\nR2 a b 12000\nC1 a out .022u\nC2 b 0 1e-8\n") + out +
                 "\n.ends f\n",
             "f.sub");
    for (const double hz : {10.0, 700.0, 5e3, 1e5}) {
      const Complex h = network_response(netlist, {Hertz{hz}})[0], wanted = sallen_key(Hertz{hz}, 200.0);
      EXPECT_LT(std::abs(h - wanted), 1e-9 * std::abs(wanted)) << hz;
    }
  }
}

TEST(SpiceReader, PinsOfAnyNameAreInputAndOutput) {
  const Netlist netlist = read(
      ".subckt half a b\nR1 a b 1k\nR2 b 0 1k\n.ends\n"
      ".subckt both x in\nXone x out HALF\nE1 m 0 out 0 1\nXtwo m in half\n.ends\n",
      "two.sub");
  // The inner nodes that are called in and out are others.
  EXPECT_LT(std::abs(network_response(netlist, {Hertz{100.0}})[0] - 0.25), 1e-12);
}

TEST(SpiceReader, OpAmpsOfSeveralTypes) {
  const std::string two =
      ".subckt t in out\nR1 in m 1k\nR2 m a 1k\nXa 0 m a TL072\nR3 a n 1k\nR4 n out 1k\nXb 0 n out op27\n.ends\n";
  const Netlist netlist = read(two, "t.sub");
  EXPECT_EQ(netlist.opamp.name, "TL072");
  EXPECT_EQ(netlist.groups.size(), 2u);  // the parts behind the first op-amp begin another
  EXPECT_EQ(netlist.model_of(netlist.opamps[1]).name, "OP27");
  // A third one, and all of them printed and read back.
  SpiceLibrary three = read_spice(two.substr(0, two.size() - 6) + "E2 q 0 out 0 5\n.ends\n", "t.sub");
  EXPECT_EQ(three.two_port(three.top).groups.size(), 2u)
      << "op-amps, however written, stand beside one another";
  const std::string text = spice_text(three);
  const Netlist back = read(text, "t.sub");
  ASSERT_EQ(back.opamps.size(), 3u);
  EXPECT_EQ(back.model_of(back.opamps[1]).name, "OP27");
  EXPECT_EQ(back.model_of(back.opamps[2]).dc_gain, 5.0);
  EXPECT_EQ(spice_text(read_spice(text, "t.sub")), text);
  // What a maker says of it is passed over.
  const std::string made = ".subckt TL072 1 2 3 4 5\nJ1 1 2 3 model\n.ends\n" + two;
  EXPECT_EQ(read(made, "t.sub").opamp.name, "TL072");
}

TEST(SpiceReader, SwitchedCapacitorsAreAnInputAnOutputAndContactsThatClocksMove) {
  const SpiceLibrary library = read_spice(
      ".clock main 100k\nV1 in 0\nS1 in a main.1\nS2 a n MAIN.2\nC1 a 0 1p\nC2 n y 10p\n"
      "O1 0 n y noise=5n gbw=10meg\nO2 0 n y2\n.output y\n.end\nQ1 no element\n",
      "filter.sc");
  const Subcircuit& deck = library.subcircuits.at(0);
  EXPECT_THAT(deck.pins, testing::ElementsAre("in", "y"));
  ASSERT_EQ(deck.netlist.contacts.size(), 2u);
  ASSERT_EQ(deck.netlist.clock_phases.size(), 2u);
  EXPECT_EQ(deck.netlist.contacts[1].control, deck.netlist.clock_phases[1].node);
  EXPECT_EQ(deck.netlist.clock_phases[1].phase, 2);
  EXPECT_EQ(deck.netlist.clock_phases[1].frequency.value, 100e3);
  EXPECT_EQ(deck.netlist.model_of(deck.netlist.opamps[0]).voltage_noise_v_per_rthz, 5e-9);
  EXPECT_EQ(deck.netlist.model_of(deck.netlist.opamps[0]).gain_bandwidth.value, 10e6);
  EXPECT_TRUE(deck.netlist.model_of(deck.netlist.opamps[1]).is_ideal);
  EXPECT_THAT(refusal(".clock main 100k\nV1 in 0\nS1 in out main.1\n", "x.sc"), HasSubstr("deck has clocks"));
}

TEST(SpiceReader, WhatItDoesNotKnowIsOneLineWithItsPlace) {
  const auto of = [](const std::string& line) {
    return refusal(".subckt t in out\nR1 in out 1k\nC1 out 0 1n\n" + line + "\n.ends\n", "t.sub");
  };
  EXPECT_EQ(of("* a comment"), "read");
  EXPECT_THAT(of("G1 out 0 in 0 1m"), HasSubstr("t.sub:4: 'G1' is no element of these netlists"));
  EXPECT_THAT(of("X1 in out LM741"),
              HasSubstr("t.sub:4: 'LM741' is neither a subcircuit of this file nor a type"));
  EXPECT_THAT(of("X1 in out out out TL072"), HasSubstr("t.sub:4: has 4 pins"));
  EXPECT_THAT(of("R2 out 0 0"), HasSubstr("t.sub:4: '0' is no value of a part"));
  EXPECT_THAT(of("R2 out 0 {r}"), HasSubstr("t.sub:4: '{r}' is no parameter"));
  EXPECT_THAT(of("R2 out 0 many"), HasSubstr("t.sub:4: 'many' is no number"));
  EXPECT_THAT(of("V2 out in 1"), HasSubstr("t.sub:4: a source stands between two nodes"));
  EXPECT_THAT(of("D1 out 0 1N4148"), HasSubstr("t.sub:4: is a diode of another model"));
  EXPECT_THAT(refusal(".subckt t in out gnd2\nR1 in out 1k\n.ends\n", "t.sub"), HasSubstr("t has 3 pins"));
  EXPECT_THAT(refusal(".subckt t in out\nR1 in out 1k\n", "t.sub"), HasSubstr("is not ended"));
  EXPECT_THAT(refusal("", "t.sub"), HasSubstr("has no subcircuit"));
  EXPECT_THAT(refusal(".subckt t in out\nR1 in a 1k\n.ends\n", "t.sub"),
              HasSubstr("t has nothing at its output, node out"));
  EXPECT_THAT(refusal(".subckt t in out\nR1 in out 1k\nX1 in out t\n.ends\n", "t.sub"),
              HasSubstr("t holds itself"));
  std::string doubled = ".subckt t0 in out\nR1 in out 1k\n.ends\n";
  for (int i = 1; i < 30; ++i)
    doubled += fmt::format(".subckt t{0} in out\nX1 in out t{1}\nX2 in out t{1}\n.ends\n", i, i - 1);
  EXPECT_THAT(refusal(doubled, "t.sub"), HasSubstr("has more than 10000 parts"));
}

}  // namespace
}  // namespace bodesmith::schematic
