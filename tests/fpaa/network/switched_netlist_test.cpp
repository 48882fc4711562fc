#include "fpaa/network/switched_netlist.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/files.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

std::string cauer_text() {
  return read_file(std::filesystem::path(BODESMITH_SOURCE_DIR) / "examples/switched_capacitor/cauer.sc");
}

/// The example at a clock `times` as fast.
SwitchedNetlist cauer_at(int times) {
  std::string text = cauer_text();
  const auto replace_all = [&](const std::string& what, const std::string& with) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
      text.replace(at, what.size(), with);
  };
  replace_all(" 0.1\n", fmt::format(" {:.9g}\n", 0.1 / times));
  replace_all(".clock main 10\n", fmt::format(".clock main {}\n", 10 * times));
  return SwitchedNetlist::read(text, "cauer.sc");
}

/// The doubly terminated ladder that it imitates: 1 ohm, c1, l1 beside c2, c3, l2 beside c4, c5 beside 1 ohm.
Complex ladder(double w) {
  const Complex s(0.0, w);
  const double l1 = 1.304, l2 = 0.8586;
  const double c2 = 1.0 / (1.704992 * 1.704992 * l1), c4 = 1.0 / (1.179945 * 1.179945 * l2);
  // From the end to the source: 1 V at the end.
  Complex v = 1.0;
  Complex i = v * (1.0 + s * 0.7262);
  v += i / (1.0 / (s * l2) + s * c4);
  i += v * s * 1.682;
  v += i / (1.0 / (s * l1) + s * c2);
  i += v * s * 1.072;
  return 1.0 / (v + i);
}

/// Largest difference of the magnitudes, in and beyond the pass band.
double ladder_error(int times) {
  const PeriodicNetworks filter = cauer_at(times).networks();
  double out = 0.0;
  for (const double w : {0.01, 0.3, 0.7, 0.9, 1.0, 1.1799, 1.3, 1.705, 2.0})
    out = std::max(out, std::abs(std::abs(filter.gain({w})) - std::abs(ladder(w))));
  return out;
}

TEST(SwitchedNetlist, TheCauerFilterIsItsLadderAsTheClockGrows) {
  const double at10 = ladder_error(10);
  const double at100 = ladder_error(100);
  EXPECT_LT(ladder_error(1), 0.1);
  EXPECT_LT(at10, 0.01);
  EXPECT_LT(at100, 0.15 * at10);
  EXPECT_NEAR(std::abs(cauer_at(1).networks().gain({1e-6})), 0.5, 1e-9);
}

TEST(SwitchedNetlist, NoiseOfTheCauerFilterIsThatOfItsLadderWithinItsBand) {
  // In the pass band a doubly terminated ladder of R at both ends has some kT R of noise; the switched one's
  // resistors have 2 kT T/C each, of which the leapfrog has eleven.
  const SwitchedNetlist cauer = cauer_at(1);
  const PeriodicNetworks filter = cauer.networks(300.0);
  const double low = filter.noise_density(Hertz{0.01}.rad_s())[0] / cauer.unit_f;  // in kT
  EXPECT_GT(low, 4.0 * 0.5);
  EXPECT_LT(low, 4.0 * 11.0);
  EXPECT_LT(filter.noise_density(Hertz{1.0}.rad_s())[0] / cauer.unit_f, 0.2 * low);
}

TEST(SwitchedNetlist, MistakesAreNamedByLine) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      (void)SwitchedNetlist::read(text, "x.sc").networks();
    } catch (const std::exception& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message(".clock a 1k\nV1 in 0\nC1 in b q1\n.output b\n"), "x.sc:3: 'q1' is no number");
  EXPECT_NE(message(".clock a 1k\nV1 in 0\nV2 b 0\n").find("x.sc:3: has no value, and there is an input"),
            std::string::npos);
  EXPECT_NE(message(".clock a 0\n").find("x.sc:1: expected .clock NAME FREQUENCY"), std::string::npos);
  EXPECT_NE(message(".clock a 1k\n.clock A 2k\n").find("x.sc:2: clock A is there already"),
            std::string::npos);
  EXPECT_NE(message(".clock a 1k\n.clock b 1.2345678k\nC1 in b 1p\n").find("ratio of whole numbers"),
            std::string::npos);
  EXPECT_NE(message(".clock a 1k\nO1 0 b c noise=5n\n").find("x.sc:2: expected O NAME"), std::string::npos);
  EXPECT_NE(message(".clock a 1k\nS1 x y b.1\n").find("x.sc:2: 'b.1' is no phase"), std::string::npos);
  EXPECT_NE(message("Q1 a b 1k\n").find("x.sc:1: 'Q1' is no element"), std::string::npos);
  EXPECT_NE(message("V1 in 0\nC1 in out 1p\n").find("there is no clock"), std::string::npos);
  EXPECT_NE(message(".clock a 1k\nV1 in 0\nR1 in out 1k\nC1 out 0 1p\n").find("R1 is no capacitor"),
            std::string::npos);
  EXPECT_NE(
      message(".clock a 1k\nV1 in 0\nC1 in b 1p\nO1 0 b out\n.output out\n").find("leave a voltage open"),
      std::string::npos);
}

TEST(SwitchedNetlist, TheOrderOfOpAmpsIsNoMatterOfTheirNoise) {
  // The first is ideal and the second is not, or the other way round.
  const std::string rest =
      ".clock main 1meg\nV1 in 0\nS1 in a main.1\nS2 a n main.2\nC1 a 0 1p\nC2 n x 2p\nS3 n x main.1\n"
      "C3 x m 1p\nC4 m y 3p\nS4 m y main.1\n.output y\n";
  const std::string ideal = "O1 0 n x\n", noisy = "O2 0 m y noise=40n gbw=8meg\n";
  const auto one = SwitchedNetlist::read(rest + ideal + noisy, "a.sc"),
             other = SwitchedNetlist::read(rest + noisy + ideal, "b.sc");
  const PeriodicNetworks a = one.networks(300.0), b = other.networks(300.0),
                         quiet = SwitchedNetlist::read(rest + ideal + "O2 0 m y\n", "c.sc").networks(300.0);
  for (const double hz : {1e3, 2e5, 9e5}) {
    const double w = 2.0 * std::numbers::pi * hz, density = a.noise_density({w})[0];
    EXPECT_NEAR(b.noise_density({w})[0] / density, 1.0, 1e-9);
    EXPECT_GT(density, 1.05 * quiet.noise_density({w})[0]);
  }
}

TEST(SwitchedNetlist, SettledAreTheTimeConstantsOfTheSlowestPhase) {
  // beta is 1 in one phase and 1/4 in the other, of half a microsecond each: 2 pi gbw beta T.
  for (const char* phase : {"1", "2"}) {
    const auto netlist = SwitchedNetlist::read(
        std::string(
            ".clock main 1meg\nV1 in 0\nS1 in a main.1\nC1 a n 2p\nC2 n x 2p\nC3 c 0 6p\nS3 n c main.") +
            phase + "\nS2 n x main.2\nS4 a 0 main.2\nO1 0 n x noise=5n gbw=10meg\n.output x\n",
        "a.sc");
    const double settled = netlist.networks(300.0).settled();
    const double beta = phase[0] == '1' ? 2.0 / 10.0 : 2.0 / 4.0;
    EXPECT_NEAR(settled, 2.0 * std::numbers::pi * 10e6 * beta * 0.5e-6, 1e-6) << phase;
  }
}

/// A switch, a capacitor and a follower: sinc of half a period and the rest as it is, in closed form.
TEST(SwitchedNetlist, ATrackAndHold) {
  const auto netlist =
      SwitchedNetlist::read(".clock main 1meg\nV1 in 0\nS1 in b main.1\nC1 b 0 1p\n.output b\n", "hold.sc");
  const PeriodicNetworks hold = netlist.networks();
  for (const double share : {0.01, 0.3, 1.7}) {
    const double w = 2.0 * std::numbers::pi * share * 1e6;
    const double quarter = 0.25 * w * 1e-6;
    // Half a period as it is, half a period what it was at its beginning.
    const Complex wanted = 0.5 + 0.5 * std::sin(quarter) / quarter * std::polar(1.0, -quarter);
    EXPECT_LT(std::abs(hold.gain({w}) - wanted), 1e-12);
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
