// Netlists in time, at rest, as text and as branches, against closed forms and against one another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <optional>

#include "base/error.hpp"
#include "kept_text.hpp"
#include "numeric/random.hpp"
#include "schematic/analysis/equations.hpp"
#include "schematic/analysis/in_time.hpp"
#include "schematic/analysis/operating_point.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/analysis/rest_point.hpp"
#include "schematic/netlist.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/ngspice/plain_netlist.hpp"
#include "schematic/series_parallel.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::schematic {
namespace {

Part made_part(Part::Kind kind, const char* name, const char* from, const char* to, double value) {
  return {kind, name, "", 0, from, to, "exact", value, value};
}
Part ohms(const char* name, const char* from, const char* to, double value) {
  return made_part(Part::Kind::resistor, name, from, to, value);
}
Part farads(const char* name, const char* from, const char* to, double value) {
  return made_part(Part::Kind::capacitor, name, from, to, value);
}
Part diode(const char* name, const char* from, const char* to) {
  return {Part::Kind::diode, name, "", 0, from, to, "1N4148", 0.0, 0.0};
}

TEST(InTime, AnRcFollowsItsExponential) {
  Netlist rc;
  rc.parts = {ohms("R", "in", "out", 1e4), farads("C", "out", "0", 1e-7), ohms("R2", "in", "slow", 3e4),
              farads("C2", "slow", "0", 1e-7)};
  InTime run(rc, [](double) { return 2.0; });
  run.begin(0.0, {{"out", -1.0}, {"in", 2.0}, {"slow", 3.0}});
  double last = 0.0;
  run.run_to(4e-3, [&](double from, double to) {
    EXPECT_EQ(from, last);
    last = to;
    EXPECT_NEAR(run.volts("out", to), 2.0 - 3.0 * std::exp(-to / 1e-3), 1e-5);
    EXPECT_NEAR(run.volts("slow", to), 2.0 + std::exp(-to / 3e-3), 1e-5);
  });
  EXPECT_NEAR(last, 4e-3, 1e-12);
  EXPECT_EQ(run.volts("in", 4e-3), 2.0);
  EXPECT_EQ(run.volts("0", 4e-3), 0.0);
  // Through 0 at 1 ms times ln 1.5, from the state that was left.
  InTime again(rc, [](double) { return 2.0; });
  again.begin(0.0, {{"out", -1.0}, {"in", 2.0}});
  const auto rises = again.rises("out", 4e-3);
  ASSERT_TRUE(rises);
  EXPECT_NEAR(*rises, 1e-3 * std::log(1.5), 1e-8);
  EXPECT_FALSE(again.rises("out", 8e-3));
}

TEST(InTime, ASineThroughAnRcIsItsResponse) {
  Netlist rc;
  rc.parts = {ohms("R", "in", "out", 1e4), farads("C", "out", "0", 1e-7)};
  const double w = 700.0;
  InTime run(rc, [w](double t) { return std::sin(w * t); });
  run.begin(0.0);
  const double end = 12e-3;  // twelve time constants
  run.run_to(end);
  const std::complex<double> h = 1.0 / std::complex<double>(1.0, w * 1e-3);
  EXPECT_NEAR(run.volts("out", end), std::abs(h) * std::sin(w * end + std::arg(h)), 2e-5);
}

/// Op-amps of either type, of their own bandwidth and output resistance: what the small signal's equations say.
TEST(InTime, ASineThroughOpAmpsIsTheirResponse) {
  for (const double hz : {2e5, 5e6}) {
    for (const double ohm : {20.0, 400.0}) {
      Netlist n;
      n.parts = {ohms("R1", "in", "m", 1e3), ohms("R2", "m", "a", 5e3), farads("C1", "a", "0", 2e-9),
                 ohms("R3", "out", "0", 1e4)};
      n.opamps = {{"U1", "", 0, "0", "m", "a"}, {"U2", "", 0, "a", "out", "out", 1}};
      n.opamp.gain_bandwidth = Hertz{hz};
      n.opamp.output_resistance_ohm = ohm;
      n.other_opamps.resize(1);
      n.other_opamps[0].gain_bandwidth = Hertz{3.0 * hz};
      n.other_opamps[0].output_resistance_ohm = 2.0 * ohm;
      const double w = 2.0 * M_PI * 2e4;
      InTime run(n, [w](double t) { return 0.01 * std::sin(w * t); });
      run.begin(0.0);
      const double end = 6e-4;
      run.run_to(end);
      const std::complex<double> h = network_response(n, {Hertz{2e4}}).front();
      EXPECT_NEAR(run.volts("out", end), 0.01 * std::abs(h) * std::sin(w * end + std::arg(h)), 3e-6)
          << hz << " " << ohm;
    }
  }
}

/// Op-amps of ten degrees of phase margin, one behind the other: formulas of order three and more took steps of half a microsecond
/// over all of a slow ramp.
TEST(InTime, OpAmpsThatHardlyDampTheirLoadsDoNotHoldItUp) {
  Netlist chain;
  chain.parts = {
      ohms("R11", "in", "m1", 110e3),    farads("C11", "in", "m1", 150e-9), farads("C31", "in", "m1", 22e-9),
      ohms("R21", "m1", "a", 62e3),      farads("C21", "m1", "a", 220e-9),  ohms("R12", "a", "m2", 270e3),
      ohms("Rs2", "a", "c2", 10.0),      farads("C12", "c2", "m2", 33e-9),  ohms("R22", "m2", "b", 430e3),
      farads("C22", "m2", "b", 33e-9),   ohms("R13", "b", "m3", 1.6e6),     ohms("Rs3", "b", "c3", 10.0),
      farads("C13", "c3", "m3", 3.9e-9), ohms("R23", "m3", "d", 1.5e6),     farads("C23", "m3", "d", 3.3e-9),
      ohms("R14", "d", "m4", 1.1e6),     ohms("Rs4", "d", "c4", 10.0),      farads("C14", "c4", "m4", 120e-9),
      ohms("R24", "m4", "out", 1.3e6),   farads("C24", "m4", "out", 100e-9)};
  chain.opamps = {{"U1", "", 0, "0", "m1", "a"},
                  {"U2", "", 0, "0", "m2", "b"},
                  {"U3", "", 0, "0", "m3", "d"},
                  {"U4", "", 0, "0", "m4", "out"}};
  InTime run(chain, [](double t) { return 12.0 * t; });
  run.begin(0.0);
  int steps = 0;
  run.run_to(83.17e-3, [&](double, double) { ++steps; });
  EXPECT_LT(steps, 20'000);
}

TEST(InTime, AnOpAmpSlewsAtItsRate) {
  Netlist follower;
  follower.parts = {ohms("Rl", "out", "0", 1e6)};
  follower.opamps = {{"U1", "", 0, "in", "out", "out"}};
  follower.opamp.slew_v_per_s = 1e6;
  follower.opamp.gain_bandwidth = Hertz{1e7};
  InTime run(follower, [](double) { return 10.0; });
  run.begin(0.0, {{"in", 10.0}});
  run.run_to(6e-6);
  EXPECT_NEAR((run.volts("out", 6e-6) - run.volts("out", 5.99e-6)) / 1e-8, 1e6, 0.05e6);
  run.run_to(30e-6);
  EXPECT_NEAR(run.volts("out", 30e-6), 10.0, 1e-3);
}

TEST(InTime, AnOpAmpEndsAtItsSwingEitherWay) {
  Netlist follower;
  follower.parts = {ohms("Rl", "out", "0", 1e6)};
  follower.opamps = {{"U1", "", 0, "in", "out", "out"}};
  for (const double side : {1.0, -1.0}) {
    InTime run(follower, [side](double) { return 20.0 * side; });
    run.begin(0.0, {{"in", 20.0 * side}});
    run.run_to(20e-6);
    // A millivolt beyond it takes the whole slewing current; the output's resistance and its load divide that.
    const double beyond =
        (follower.opamp.swing_v + 1e-3) / (1.0 + follower.opamp.output_resistance_ohm / 1e6);
    EXPECT_NEAR(run.volts("out", 20e-6), side * beyond, 1e-5);
  }
}

Netlist one_contact() {
  Netlist n;
  n.parts = {ohms("R", "so", "0", 1e6)};
  n.sources = {{"V1", "", "v", 1.0}};
  n.contacts = {{"S1", 0, "v", "so", "in", 0}};
  n.analog_switch.on_ohm = 100.0;
  return n;
}

TEST(InTime, AContactClosesAndOpensAfterItsDelays) {
  const Netlist n = one_contact();
  const double opens = 2e-6;
  InTime run(n, [opens](double t) { return t < opens ? 1.0 : 0.0; });
  run.begin(0.0, {{"v", 1.0}, {"in", 1.0}});
  std::optional<double> closed;
  run.run_to(opens, [&](double, double to) {
    if (!closed && run.volts("so", to) > 0.5) closed = to;
  });
  ASSERT_TRUE(closed);
  EXPECT_NEAR(*closed, n.analog_switch.on_delay_s, 0.3 * n.analog_switch.on_delay_s);
  EXPECT_NEAR(run.volts("so", opens), 1e6 / (1e6 + 100.0), 1e-4);
  // An open one leaves the node to its resistor.
  run.run_to(opens + 100e-6);
  EXPECT_LT(run.volts("so", opens + 100e-6), 0.01);
}

// .5 + .5 tanh(gain (v - threshold)), and the product of levels and of 1 less levels.
TEST(InTime, LevelsFollowTheirInputs) {
  Netlist n;
  n.parts = {ohms("R", "in", "x", 1e4), farads("C", "x", "0", 1e-10)};
  n.comparators = {{0, "in", "a", 3.0, 0.2}, {0, "x", "b", -2.0, -0.1}, {0, "x", "c", 1.0, 0.0}};
  n.gates = {{0, "g", {"a", "b"}, {"c"}}};
  InTime run(n, [](double t) { return std::sin(600.0 * t); });
  run.begin(0.0);
  const auto level = [](double gain, double v, double threshold) {
    return 0.5 + 0.5 * std::tanh(gain * (v - threshold));
  };
  for (const double t : {1e-3, 2e-3, 4e-3, 7e-3}) {
    run.run_to(t);
    const double in = std::sin(600.0 * t), x = run.volts("x", t);
    EXPECT_NEAR(run.volts("a", t), level(3.0, in, 0.2), 1e-4) << t;
    EXPECT_NEAR(run.volts("b", t), level(-2.0, x, -0.1), 1e-4) << t;
    EXPECT_NEAR(run.volts("g", t), level(3.0, in, 0.2) * level(-2.0, x, -0.1) * (1.0 - level(1.0, x, 0.0)),
                1e-4);
  }
}

/// Well before and behind its level a moving contact is the one that stays open or closed, but for the charge on its gate.
TEST(Equations, AMovingContactAtRestIsOneThatStays) {
  Netlist moving = one_contact();
  moving.analog_switch.drain_f = 7e-12;
  moving.analog_switch.source_f = 3e-12;
  const Equations equations(moving, {.switching = true});
  for (const bool closed : {false, true}) {
    Netlist still = moving;
    still.contacts[0].position = closed ? 0 : 1;
    const Equations stays(still, {});
    const auto added = [&](const Equations& from, double v, double so) {
      const auto size = static_cast<std::size_t>(from.unknowns());
      std::vector<double> x(size, closed ? 1.0 : 0.0), f(size, 0.0), q(size, 0.0);
      std::vector<Stamps::Slope> slopes;
      x[static_cast<std::size_t>(from.node("v"))] = v;
      x[static_cast<std::size_t>(from.node("so"))] = so;
      from.evaluate({x, closed ? 1.0 : 0.0, {}}, f, q, slopes);
      const auto at = static_cast<std::size_t>(from.node("so"));
      return std::pair{f[at], q[at]};
    };
    for (const auto& [v, so] : {std::pair{1.0, 0.3}, {-0.5, 0.8}}) {
      const auto [f, q] = added(equations, v, so);
      const auto [f0, q0] = added(equations, 0.0, 0.0);
      const auto [g, p] = added(stays, v, so);
      EXPECT_NEAR(f, g, 1e-7 * std::abs(g)) << closed;
      EXPECT_NEAR(q - q0, p, 1e-6 * std::abs(p)) << closed;
    }
  }
}

TEST(Noise, OfAClosedContactIsThatOfItsResistance) {
  Netlist n = one_contact();
  n.parts = {farads("C", "so", "0", 1e-15)};
  n.contacts[0].from = "in";
  const double density = output_noise(n, {Hertz{1e3}}, true, "so").front();
  EXPECT_NEAR(density / std::sqrt(4.0 * kBoltzmann * kKelvin * 100.0), 1.0, 1e-3);
}

TEST(RestPoint, OfDividersOpAmpsMultipliersAndSources) {
  Netlist n;
  n.parts = {ohms("R1", "in", "a", 1e3), ohms("R2", "a", "0", 3e3), ohms("R3", "m", "out", 2e4),
             ohms("R4", "a2", "m", 1e4)};
  n.opamps = {{"U1", "", 0, "a", "a2", "a2"}, {"U2", "", 0, "0", "m", "out"}};
  n.multipliers = {{"M1", "", 0, "a2", "v", "out", "w", 0.0}};
  n.sources = {{"V1", "", "v", 0.5}};
  n.multiplier.scale_v = 2.0;
  const RestOrder order(n, {"in"});
  Deviations off = Deviations::none(n);
  RestPoint plain(order, off);
  for (const double u : {-1.0, 0.0, 0.8}) {
    plain.set(order.node("in"), u);
    plain.settle(0);
    EXPECT_NEAR(plain.volts("a"), 0.75 * u, 1e-12);
    EXPECT_NEAR(plain.volts("a2"), 0.75 * u, 1e-12);
    EXPECT_NEAR(plain.volts("out"), -1.5 * u, 1e-12);
    EXPECT_NEAR(plain.volts("w"), 0.75 * u * 0.5 / 2.0 - 1.5 * u, 1e-12);
  }
  EXPECT_NEAR(plain.noise_gain(0), 1.0, 1e-9);
  EXPECT_NEAR(plain.noise_gain(1), 3.0, 1e-9);
  off.part[1] = 0.1;             // R2 of 3.3 kOhm
  off.opamp_offset_v[1] = 1e-3;  // three times at the output
  off.source[0] = -0.2;          // 0.4 V
  off.multiplier[0] = {0.01, -0.02, 0.003, 0.05, 0.0};
  RestPoint built(order, off);
  built.set(order.node("in"), 1.0);
  built.settle(0);
  const double a = 3.3 / 4.3;
  EXPECT_NEAR(built.volts("a2"), a, 1e-12);
  EXPECT_NEAR(std::abs(built.volts("out") + 2.0 * a), 3e-3, 1e-9);
  EXPECT_NEAR(built.volts("w"), (a + 0.01) * (0.4 - 0.02) / (2.0 * 1.05) + built.volts("out") + 0.003, 1e-12);
}

/// An op-amp whose feedback comes through an inverter: their outputs are one block.
TEST(RestPoint, OpAmpsInOneLoopAreSettledTogether) {
  Netlist n;
  n.parts = {ohms("R1", "in", "p", 1e3), ohms("R2", "p", "y", 4e3), ohms("Ra", "x", "k", 2e3),
             ohms("Rb", "k", "y", 5e3)};
  n.opamps = {{"U1", "", 0, "p", "0", "x"}, {"U2", "", 0, "0", "k", "y"}};
  const RestOrder order(n, {"in"});
  RestPoint rest(order, Deviations::none(n));
  rest.set(order.node("in"), 0.7);
  rest.settle(0);
  EXPECT_NEAR(rest.volts("y"), -4.0 * 0.7, 1e-12);
  EXPECT_NEAR(rest.volts("x"), 4.0 * 0.7 * 2.0 / 5.0, 1e-12);
  EXPECT_NEAR(std::abs(rest.noise_gain(0)), 5.0 * 2.0 / 5.0, 1e-9);
  EXPECT_NEAR(rest.noise_gain(1), 0.0, 1e-9);
  // What another copy of the same order knows is taken over where it is the same, and nowhere else.
  for (const std::size_t part : {0u, 2u}) {
    Deviations off = Deviations::none(n);
    off.part[part] = 0.3;
    RestPoint alone(order, off), like(order, off, &rest);
    for (RestPoint* one : {&alone, &like}) {
      one->set(order.node("in"), 0.7);
      one->settle(0);
    }
    for (const char* node : {"x", "y", "p", "k"}) EXPECT_NEAR(like.volts(node), alone.volts(node), 1e-13);
    EXPECT_NE(alone.volts("x"), rest.volts("x"));
  }
}

TEST(RestPoint, ContactsOfAnotherResistanceAreSolvedAnew) {
  Netlist n;
  n.parts = {ohms("R1", "c", "0", 1e3), ohms("R2", "d", "0", 1e3)};
  n.contacts = {{"S1", 0, "in", "c", "up", 0}, {"S2", 0, "in", "d", "down", 1}};
  n.analog_switch.on_ohm = 100.0;
  const RestOrder order(n, {"in"});
  RestPoint plain(order, Deviations::none(n));
  plain.set(order.node("in"), 1.0);
  plain.settle(0);
  EXPECT_NEAR(plain.volts("c"), 1.0 / 1.1, 1e-6);
  Deviations off = Deviations::none(n);
  off.switch_relative = 1.0;
  RestPoint other(order, off, &plain);
  other.set(order.node("in"), 1.0);
  other.settle(0);
  EXPECT_NEAR(other.volts("c"), 1.0 / 1.2, 1e-6);
  other.settle(1);
  EXPECT_NEAR(other.volts("d"), 1.0 / 1.2, 1e-6);
}

/// Which of them conduct is kept in 64 bits.
TEST(RestPoint, MoreDiodesAtOneNodeThanItCountsAreRefused) {
  Netlist n;
  n.parts = {ohms("R1", "in", "a", 1e3)};
  std::vector<std::string> nodes;
  for (int k = 0; k < 65; ++k) nodes.push_back("n" + std::to_string(k));
  for (const std::string& node : nodes) {
    n.parts.push_back(ohms("R2", "a", node.c_str(), 65e3));
    n.parts.push_back(diode("D1", node.c_str(), "0"));
  }
  EXPECT_THROW(RestOrder(n, {"in"}), DesignError);
  n.parts.pop_back();
  const RestOrder order(n, {"in"});
  RestPoint rest(order, Deviations::none(n));
  rest.set(order.node("in"), 1.0);
  rest.settle(0);
  EXPECT_NEAR(rest.volts("a"), 65.0 / (64.0 + 65.0), 1e-12);
}

TEST(RestPoint, DiodesConductOneWayAndContactsWhereTheyStand) {
  Netlist n;
  n.parts = {ohms("R1", "in", "a", 1e3), diode("D1", "a", "b"), ohms("R2", "b", "0", 3e3)};
  n.contacts = {{"S1", 0, "in", "c", "up", 0}, {"S2", 0, "b", "c", "down", 1}};
  n.parts.push_back(ohms("R3", "c", "0", 1e6));
  n.analog_switch.on_ohm = 1.0;
  n.analog_switch.off_siemens = 1e-12;
  const RestOrder order(n, {"in"});
  RestPoint rest(order, Deviations::none(n));
  const auto at = [&](double u, int position, const char* node) {
    rest.set(order.node("in"), u);
    rest.settle(position);
    return rest.volts(node);
  };
  EXPECT_NEAR(at(2.0, 0, "b"), 1.5, 1e-5);
  EXPECT_NEAR(at(-2.0, 0, "b"), 0.0, 1e-5);
  EXPECT_NEAR(at(2.0, 0, "b"), 1.5, 1e-5);
  EXPECT_NEAR(at(-2.0, 0, "a"), -2.0, 1e-5);
  EXPECT_NEAR(at(2.0, 0, "c"), 2.0, 1e-5);
  EXPECT_NEAR(at(2.0, 1, "c"), at(2.0, 1, "b"), 1e-5);
}

// An inverting half-wave rectifier: y = -u R2/R1 where u > 0, else 0, whichever diode conducted before.
TEST(RestPoint, AnOpAmpsDiodesRectify) {
  Netlist n;
  n.parts = {ohms("R1", "in", "m", 1e4), ohms("R2", "m", "y", 2.5e4), diode("D1", "y", "u"),
             diode("D2", "u", "m")};
  n.opamps = {{"U1", "", 0, "0", "m", "u"}};
  const RestOrder order(n, {"in"});
  RestPoint rest(order, Deviations::none(n));
  for (const double u : {1.0, -2.0, -0.1, 0.3, 4.0, -4.0}) {
    rest.set(order.node("in"), u);
    rest.settle(0);
    EXPECT_NEAR(rest.volts("y"), u > 0.0 ? -2.5 * u : 0.0, 1e-9) << u;
    EXPECT_NEAR(rest.volts("m"), 0.0, 1e-12) << u;
    const auto all = operating_point(n, {{"in", u}}, 0, Deviations::none(n), {{"y", u > 0.0 ? -u : 0.0}});
    EXPECT_NEAR(all.at("y"), rest.volts("y"), 1e-9) << u;
  }
}

/// Drawn circuits of stages that load one another rest, with drawn errors, in both positions and wherever they come from, where all
/// equations at once say.
TEST(RestPoint, DrawnCircuitsRestWhereAllEquationsAtOnceSay) {
  Random random(11);
  const auto whole = [&](std::size_t n) {
    return std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(n)), n - 1);
  };
  for (int circuit = 0; circuit < 60; ++circuit) {
    Netlist n;
    n.analog_switch.on_ohm = 50.0;
    n.sources = {{"V1", "", "v1", 0.7}};
    // Resistors hang on what sources and op-amps drive; multipliers and followers read any node.
    std::vector<std::string> nodes = {"in", "v1"}, driven = nodes;
    const auto source = [&] { return driven[whole(driven.size())].c_str(); };
    const auto any = [&] { return nodes[whole(nodes.size())].c_str(); };
    for (int stage = 0; stage < 8; ++stage) {
      const std::string k = std::to_string(stage), y = "y" + k, m = "m" + k, u = "u" + k;
      std::string made = y;
      const auto part = [&](const char* name, const char* from, const std::string& to) {
        n.parts.push_back(ohms((name + k).c_str(), from, to.c_str(), std::exp(7.0 + 3.0 * random.uniform())));
      };
      const std::size_t kind = whole(6);
      if (kind == 0 || kind == 4) {  // a sum; one that rectifies
        part("Ra", source(), m), part("Rb", source(), m), part("Rf", m.c_str(), y);
        n.opamps.push_back({"U" + k, "", 0, "0", m, kind == 0 ? y : u});
        if (kind == 4) {
          n.parts.push_back(diode(("D" + k).c_str(), y.c_str(), u.c_str()));
          n.parts.push_back(diode(("E" + k).c_str(), u.c_str(), m.c_str()));
          made = "z" + k;  // nothing loads it
          n.opamps.push_back({"F" + k, "", 0, y, made, made});
        }
      } else if (kind == 1) {
        part("Ra", source(), y), part("Rb", source(), m), part("Rc", y.c_str(), m),
            part("Rd", m.c_str(), "0");
      } else if (kind == 2) {
        n.multipliers.push_back({"M" + k, "", 0, any(), any(), any(), y, 0.0});
      } else if (kind == 3) {
        n.contacts.push_back({"S" + k, 0, source(), y, "c", 0});
        n.contacts.push_back({"T" + k, 0, source(), y, "c", 1});
        part("Ra", y.c_str(), "0");
      } else {
        n.opamps.push_back({"U" + k, "", 0, any(), y, y});
      }
      nodes.push_back(made);
      if (kind != 1 && kind != 3) driven.push_back(made);
    }
    Deviations off = Deviations::none(n);
    for (double& one : off.part) one = 0.1 * random.uniform() - 0.05;
    for (double& one : off.opamp_offset_v) one = 0.02 * random.uniform() - 0.01;
    for (MultiplierDeviation& one : off.multiplier) one.x = 0.02 * random.uniform(), one.w = -0.01;
    const RestOrder order(n, {"in"});
    RestPoint moved(order, off);
    for (const double in : {0.5, -0.4, 0.1}) {
      for (const int position : {0, 1}) {
        RestPoint fresh(order, off);
        std::map<std::string, double> start;
        for (RestPoint* one : {&moved, &fresh}) one->set(order.node("in"), in), one->settle(position);
        for (const std::string& node : nodes) {
          start[node] = moved.volts(node);
          EXPECT_NEAR(moved.volts(node), fresh.volts(node), 1e-9 * (1.0 + std::abs(fresh.volts(node))))
              << node;
        }
        for (const Part& one : n.parts) {
          for (const std::string& node : {one.from, one.to}) start[node] = moved.volts(node);
        }
        const auto all = operating_point(n, {{"in", in}}, position, off, start);
        for (const std::string& node : nodes) {
          if (node == "in" || !all.contains(node)) continue;
          EXPECT_NEAR(all.at(node), moved.volts(node), 1e-8 * (1.0 + std::abs(moved.volts(node))))
              << node << " of " << circuit;
        }
      }
    }
  }
}

// Vos (1 + R2/R1) + Ib (R2 + Rp (1 + R2/R1)), the currents of both inputs at their worst.
TEST(Offset, OfAnInvertingAmplifierByHand) {
  Netlist n;
  n.parts = {ohms("R1", "in", "m", 1e4), ohms("R2", "m", "out", 9e4), ohms("Rp", "p", "0", 5e3)};
  n.opamps = {{"U1", "", 0, "p", "m", "out"}};
  n.opamp = OpAmpModel::one_pole(Hertz{1e6}, 1e9);
  n.opamp.offset_v = 2e-3;
  n.opamp.bias_current_a = 1e-7;
  EXPECT_NEAR(worst_output_offset(n), 2e-3 * 10.0 + 1e-7 * (9e4 + 5e3 * 10.0), 1e-8);
}

TEST(SwitchTimer, CrossesItsLevelAfterBothDelays) {
  SwitchModel model;
  const SwitchTimer timer = SwitchTimer::of(model);
  EXPECT_NEAR(1.0 - std::exp(-model.on_delay_s / timer.tau_s), timer.level, 1e-9);
  EXPECT_NEAR(std::exp(-model.off_delay_s() / timer.tau_s), timer.level, 1e-9);
  model.gap_s = model.on_delay_s;
  EXPECT_THROW(SwitchTimer::of(model), DesignError);
  model.gap_s = -1e-9;
  EXPECT_THROW(SwitchTimer::of(model), DesignError);
}

TEST(OpAmpModel, TheOpenLoopIsOneAtItsBandwidth) {
  OpAmpModel model;
  model.dc_gain = 1e5;
  model.gain_bandwidth = Hertz{1e6};
  EXPECT_NEAR(std::abs(model.open_loop({0.0})), 1e5, 1e-6);
  EXPECT_NEAR(std::abs(model.open_loop(Hertz{1e6}.rad_s())), 1.0, 1e-9);
  EXPECT_NEAR(std::arg(model.open_loop(Hertz{10.0}.rad_s())), -M_PI / 4.0, 1e-12);
}

/// The impedance of branches between two nodes.
std::complex<double> impedance(const Branch& branch, const std::vector<Part>& parts, double w) {
  if (branch.kind == Branch::Kind::part) {
    const Part& part = parts[branch.part];
    return part.kind == Part::Kind::resistor ? std::complex<double>(part.realised)
                                             : 1.0 / std::complex<double>(0.0, w * part.realised);
  }
  std::complex<double> sum = 0.0;
  for (const Branch& child : branch.children)
    sum +=
        branch.kind == Branch::Kind::series ? impedance(child, parts, w) : 1.0 / impedance(child, parts, w);
  return branch.kind == Branch::Kind::series ? sum : 1.0 / sum;
}

TEST(SeriesParallel, AWholeLadderIsOneBranchOfItsImpedance) {
  const std::vector<Part> parts = {ohms("R1", "in", "a", 1e3), farads("C1", "a", "out", 1e-8),
                                   ohms("R2", "b", "a", 2e3), farads("C2", "b", "out", 3e-8),
                                   ohms("R3", "out", "b", 5e3)};
  const auto branches = series_parallel_branches(parts, {"in", "out"});
  ASSERT_EQ(branches.size(), 1u);
  EXPECT_TRUE(branches[0].joins("out", "in"));
  EXPECT_TRUE(branches[0].ends_at("in"));
  EXPECT_EQ(branches[0].other_end("in"), "out");
  const double w = 2e4;
  const std::complex<double> j(0.0, 1.0);
  const auto wanted = 1e3 + 1.0 / (j * w * 1e-8 + 1.0 / (2e3 + 1.0 / (j * w * 3e-8 + 1.0 / 5e3)));
  EXPECT_LT(std::abs(impedance(branches[0], parts, w) / wanted - 1.0), 1e-12);
  // Turned round it is the same from the other side.
  const Branch turned = branches[0].from(branches[0].right);
  EXPECT_EQ(turned.left, branches[0].right);
  EXPECT_EQ(turned.right, branches[0].left);
  EXPECT_LT(std::abs(impedance(turned, parts, w) / wanted - 1.0), 1e-12);
  for (const Branch& branch : {branches[0], turned}) {
    ASSERT_EQ(branch.kind, Branch::Kind::series);
    std::string node = branch.left;
    for (const Branch& child : branch.children) {
      EXPECT_EQ(child.left, node);
      node = child.right;
    }
    EXPECT_EQ(node, branch.right);
  }
  // Any number side by side are one.
  EXPECT_EQ(
      series_parallel_branches(
          {ohms("1", "in", "out", 1), ohms("2", "out", "in", 1), ohms("3", "in", "out", 1)}, {"in", "out"})
          .size(),
      1u);
  // A node that is kept is not passed over; a bridge is no series and no parallel.
  EXPECT_EQ(series_parallel_branches(parts, {"in", "out", "a"}).size(), 2u);
  EXPECT_EQ(
      series_parallel_branches({ohms("1", "in", "a", 1), ohms("2", "in", "b", 1), ohms("3", "a", "b", 1),
                                ohms("4", "a", "out", 1), ohms("5", "b", "out", 1)},
                               {"in", "out"})
          .size(),
      5u);
}

Netlist of_everything() {
  Netlist n;
  n.groups = {{"stage 1", Purpose::stage}};
  n.parts = {ohms("R1", "in", "m", 4.7e3), farads("C1", "m", "out", 2.2e-9), diode("D1", "out", "d"),
             ohms("R2", "d", "0", 1e4)};
  n.opamps = {{"U1", "", 0, "0", "m", "out"}, {"U2", "", 0, "d", "e", "e", 1}};
  n.multipliers = {{"M1", "", 0, "out", "v", "0", "w", 0.0}};
  n.contacts = {{"S1", 0, "w", "so", "up", 0}, {"S2", 0, "out", "so", "down", 1}};
  n.sources = {{"V1", "", "v", 0.25}};
  n.comparators = {{0, "e", "up", 1e4, 0.1}};
  n.gates = {{0, "down", {}, {"up"}}};
  n.parts.push_back(ohms("R3", "so", "0", 1e5));
  n.other_opamps.emplace_back().name = "fast";
  n.other_opamps[0].gain_bandwidth = Hertz{145e6};
  return n;
}

TEST(SpiceLibrary, ReadBackItIsTheSameCircuitAndTheSameBytes) {
  SpiceLibrary library;
  library.title = "one of each";
  library.written_by = "a test";
  library.top = "all";
  library.notes = {"a note"};
  library.subcircuits = {{"all", {"in", "out", "so"}, {"what it is"}, of_everything()}};
  const std::string text = spice_text(library);
  const SpiceLibrary read = read_spice(text, "all.sub");
  EXPECT_EQ(spice_text(read), text);
  SpiceLibrary plain = library;
  plain.subcircuits[0].netlist = {};
  plain.subcircuits[0].netlist.parts = {ohms("R1", "in", "out", 1e3), farads("C1", "out", "0", 2.2e-9)};
  SpiceOptions silent;
  silent.noise = false;
  expect_kept("schematic/kept_deck.txt", text + "==== without noise\n" + spice_text(library, silent) +
                                             "==== plain\n" + spice_text(plain));
  const Netlist& back = read.subcircuit("all").netlist;
  const Netlist there = of_everything();
  ASSERT_EQ(back.parts.size(), there.parts.size());
  std::map<std::string, const Part*> named;
  for (const Part& part : back.parts) named[part.name] = &part;
  for (const Part& part : there.parts) {
    ASSERT_TRUE(named.contains(part.name)) << part.name;
    EXPECT_EQ(named[part.name]->from, part.from);
    EXPECT_EQ(named[part.name]->to, part.to);
    EXPECT_NEAR(named[part.name]->realised, part.realised, 1e-12 * part.realised);
  }
  EXPECT_EQ(back.opamps.size(), 2u);
  EXPECT_EQ(back.opamps[1].type, 1u);
  EXPECT_NEAR(back.other_opamps.at(0).gain_bandwidth.value, 145e6, 1.0);
  ASSERT_EQ(back.comparators.size(), 1u);
  EXPECT_NEAR(back.comparators[0].threshold_v, 0.1, 1e-12);
  EXPECT_NEAR(back.comparators[0].gain, 1e4, 1e-6);
  ASSERT_EQ(back.sources.size(), 1u);
  EXPECT_EQ(back.sources[0].volts, 0.25);
  EXPECT_NEAR(back.multiplier.scale_v, 1.05, 1e-12);
  EXPECT_THROW(read.subcircuit("nothing"), InputError);
}

TEST(SpiceLibrary, ASwitchedCapacitorIsReadBackAndItsPhasesNeverMeet) {
  Netlist n;
  n.clock_phases = {{"VP1", "a", Hertz{1e5}, 1, 0.02}, {"VP2", "b", Hertz{1e5}, 2, 0.02}};
  n.contacts = {{"S1", 0, "in", "c", "a", 0}, {"S2", 0, "c", "m", "b", 1}};
  n.parts = {farads("C1", "c", "0", 1e-12), farads("C2", "m", "out", 1e-11)};
  n.opamps = {{"U1", "", 0, "0", "m", "out"}};
  n.expressions = {{"B1", "e", "2*v(c)+1"}};
  n.analog_switch = SwitchModel::plain(2e3, 1e-12);
  n.opamp = OpAmpModel::one_pole(Hertz{50e6}, 1e5);
  SpiceLibrary library;
  library.title = "an integrator";
  library.top = "all";
  library.subcircuits = {{"all", {"in", "out", "a", "b"}, {}, n}};
  const std::string text = spice_text(library);
  const Netlist back = read_spice(text, "all.sub").subcircuit("all").netlist;
  ASSERT_EQ(back.clock_phases.size(), 2u);
  for (std::size_t i : {0u, 1u}) {
    EXPECT_EQ(back.clock_phases[i].node, n.clock_phases[i].node);
    EXPECT_EQ(back.clock_phases[i].phase, n.clock_phases[i].phase);
    EXPECT_NEAR(back.clock_phases[i].frequency.value, 1e5, 1e-6);
    EXPECT_NEAR(back.clock_phases[i].gap, 0.02, 1e-12);
  }
  EXPECT_EQ(back.expressions.at(0).volts, "2*v(c)+1");
  EXPECT_NEAR(back.analog_switch.on_ohm, 2e3, 1e-9);
  EXPECT_NEAR(back.analog_switch.off_siemens, 1e-12, 1e-20);
  EXPECT_NEAR(back.opamp.gain_bandwidth.value, 50e6, 1.0);
  EXPECT_NEAR(back.opamp.dc_gain, 1e5, 1e-4);
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const auto run =
      ngspice::run_transient("t\n" + text + "V1 in 0 1\nX1 in out a b all\n", {"a", "b"}, 2e-8, 2e-5, "t");
  const auto inside = [](double t, double begin) {  // of a phase that begins at .0 or .5 of a period
    const double at = t / 1e-5 - begin;
    const double part = at - std::floor(at);
    return part < 0.5;
  };
  int full[2] = {0, 0};
  for (std::size_t i = 0; i < run.time_s.size(); ++i) {
    EXPECT_LT(std::min(run.v[0][i], run.v[1][i]), 1e-9) << run.time_s[i];
    for (std::size_t k : {0u, 1u}) {
      full[k] += run.v[k][i] > 0.999 ? 1 : 0;
      EXPECT_TRUE(run.v[k][i] < 0.999 || inside(run.time_s[i], k == 0 ? 0.0 : 0.5)) << run.time_s[i];
    }
  }
  EXPECT_GT(full[0], 450);
  EXPECT_GT(full[1], 450);
}

// A deck's pins become "in" and "out" in every kind of element; what was called so becomes another node.
TEST(SpiceLibrary, PinsOfATwoPortAreRenamedEverywhere) {
  Netlist n;
  n.groups = {{"all", Purpose::stage}};
  n.parts = {ohms("R1", "p", "in", 1e3), ohms("R2", "in", "q", 1e3)};
  n.opamps = {{"U1", "", 0, "p", "in", "q"}};
  n.multipliers = {{"M1", "", 0, "p", "q", "in", "w", 0.0}};
  n.contacts = {{"S1", 0, "p", "q", "in", 0}};
  n.sources = {{"V1", "", "in", 0.25}};
  n.comparators = {{0, "p", "q", 1.0, 0.0}};
  n.gates = {{0, "q", {"p", "in"}, {"q"}}};
  SpiceLibrary library;
  library.subcircuits = {{"top", {"p", "q"}, {}, n}};
  const Netlist made = library.two_port("top");
  EXPECT_EQ(made.parts[0].from + " " + made.parts[0].to + " " + made.parts[1].to, "in in_ out");
  EXPECT_EQ(made.opamps[0].plus + " " + made.opamps[0].minus + " " + made.opamps[0].out, "in in_ out");
  const Multiplier& m = made.multipliers[0];
  EXPECT_EQ(m.x + " " + m.y + " " + m.z + " " + m.out, "in out in_ w");
  EXPECT_EQ(made.contacts[0].from + " " + made.contacts[0].to + " " + made.contacts[0].control, "in out in_");
  EXPECT_EQ(made.sources[0].node, "in_");
  EXPECT_EQ(made.comparators[0].in + " " + made.comparators[0].out, "in out");
  EXPECT_EQ(made.gates[0].out + " " + made.gates[0].high[0] + " " + made.gates[0].high[1] + " " +
                made.gates[0].low[0],
            "out in in_ out");
}

/// The first number after a word.
double number_after(const std::string& text, const std::string& word) {
  return std::stod(text.substr(text.find(word) + word.size()));
}

TEST(SpiceLibrary, AnOpAmpsNoiseIsMadeOfAResistorTwoDiodesAndACurrent) {
  OpAmpModel model;
  model.voltage_noise_v_per_rthz = 5e-9;
  model.voltage_noise_corner_hz = 400.0;
  model.current_noise_a_per_rthz = 2e-13;
  constexpr double k4T = 4.0 * 1.380649e-23 * 300.15, q = 1.602176634e-19;
  const std::string text = opamp_subcircuit(model);
  const double amperes = number_after(text, "Gb1 0 d1 VALUE={"), slope_ohm = 0.25 * k4T / q / amperes;
  EXPECT_EQ(number_after(text, "Gb2 0 d2 VALUE={"), amperes);
  // Far above the corner 4 k T R and 2 q I r^2 of two diodes; KF I/f behind each r is as much at the corner.
  EXPECT_NEAR(
      (k4T * number_after(text, "Rn vn 0 ") + 2.0 * 2.0 * q * amperes * slope_ohm * slope_ohm) / 25e-18, 1.0,
      1e-6);
  EXPECT_NEAR(
      2.0 * number_after(text, "(IS=1e-14 N=1 KF=") * amperes * slope_ohm * slope_ohm / 400.0 / 25e-18, 1.0,
      1e-6);
  EXPECT_NEAR(number_after(text, "Gp 0 p VALUE={") * std::sqrt(k4T * number_after(text, "Rp vp 0 ")) / 2e-13,
              1.0, 1e-6);
  model.voltage_noise_corner_hz = 0.0;
  EXPECT_NEAR(k4T * number_after(opamp_subcircuit(model), "Rn vn 0 ") / 25e-18, 1.0, 1e-6);
  EXPECT_EQ(opamp_subcircuit(model).find("D1"), std::string::npos);
}

TEST(PlainNetlist, TheSubcircuitOfTwoPinsThatIsMeant) {
  const auto all = ngspice::list_subcircuits(
      ".subckt first in out\n.ends\n.SUBCKT Three a b c gain=2\n.ends\n.subckt last in out params: r=1\n.subckt inner x y\n.ends\n.ends\n",
      "f.sub");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].pins.size(), 3u);
  EXPECT_EQ(all[2].pins.size(), 2u);
  EXPECT_EQ(all[2].line, 5);
  EXPECT_EQ(ngspice::pick_subcircuit(all, "", "f.sub"), "last");
  EXPECT_EQ(ngspice::pick_subcircuit(all, "FIRST", "f.sub"), "first");
  EXPECT_THROW(ngspice::pick_subcircuit(all, "three", "f.sub"), InputError);
  EXPECT_THROW(ngspice::pick_subcircuit(all, "inner", "f.sub"), InputError);
  auto named = all;
  named[0].name = "Compensator";
  EXPECT_EQ(ngspice::pick_subcircuit(named, "", "f.sub"), "Compensator");
  named[0].pins.push_back("vdd");
  EXPECT_EQ(ngspice::pick_subcircuit(named, "", "f.sub"), "last");
  EXPECT_THROW(ngspice::pick_subcircuit({all[1]}, "", "f.sub"), InputError);
  for (const char* broken : {".subckt\n.ends\n", ".ends\n", ".subckt a in out\n"})
    EXPECT_THROW(ngspice::list_subcircuits(broken, "f.sub"), InputError) << broken;
}

TEST(SpiceLibrary, DeviationsAreReadAsTheValues) {
  SpiceLibrary library;
  library.top = "all";
  library.subcircuits = {{"all", {"in", "out", "so"}, {}, of_everything()}};
  Deviations off = Deviations::none(of_everything());
  off.part[0] = 0.02;
  off.part[1] = -0.05;
  off.source[0] = 0.01;
  SpiceOptions options;
  options.off = &off;
  const Netlist back = read_spice(spice_text(library, options), "off.sub").subcircuit("all").netlist;
  EXPECT_NEAR(back.part_named("R1")->realised, 4.7e3 * 1.02, 1e-6);
  EXPECT_NEAR(back.part_named("C1")->realised, 2.2e-9 * 0.95, 1e-18);
  EXPECT_NEAR(back.part_named("R2")->realised, 1e4, 1e-8);
  EXPECT_NEAR(back.sources[0].volts, 0.2525, 1e-12);
  EXPECT_EQ(back.part_named("R9"), nullptr);
}

/// Each keeps its own, whatever the order in which the whole and the part of it have them; switch delays stay the whole's.
TEST(Deviations, OfAPartOfANetlistGoByName) {
  const Netlist whole = of_everything();
  Deviations off = Deviations::none(whole);
  const auto number = [](std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.01 * static_cast<double>(i + 1);
  };
  for (auto* values : {&off.part, &off.opamp_offset_v, &off.source}) number(*values);
  Netlist some = whole;
  std::reverse(some.parts.begin(), some.parts.end());
  some.parts.erase(some.parts.begin() + 1);
  std::reverse(some.opamps.begin(), some.opamps.end());
  const Deviations got = off.of_part(some, whole);
  ASSERT_EQ(got.part.size(), some.parts.size());
  for (std::size_t i = 0; i < some.parts.size(); ++i) {
    const auto at = std::find_if(whole.parts.begin(), whole.parts.end(),
                                 [&](const Part& one) { return one.name == some.parts[i].name; });
    EXPECT_EQ(got.part[i], off.part[static_cast<std::size_t>(at - whole.parts.begin())]);
  }
  EXPECT_EQ(got.opamp_offset_v, (std::vector{off.opamp_offset_v[1], off.opamp_offset_v[0]}));
  EXPECT_EQ(got.source, off.source);
}

/// Whatever the elements are, moving contacts and levels too: a slope that is stated is the difference quotient of what is added.
TEST(Equations, SlopesAreThoseOfWhatIsAdded) {
  for (const bool switching : {false, true}) {
    Netlist n = of_everything();
    n.comparators[0].gain = 3.0;
    const Equations equations(n, {.switching = switching});
    const auto size = static_cast<std::size_t>(equations.unknowns());
    const double level = SwitchTimer::of(n.analog_switch).level;
    Random random(switching ? 5 : 6);
    std::size_t met = 0;
    for (int draw = 0; draw < 300; ++draw) {
      std::vector<double> x(size);
      // Timers of contacts act within a four-hundredth of their level.
      for (double& one : x)
        one = random.uniform() < 0.5 ? level + (2.4 * random.uniform() - 1.2) / 400.0
                                     : 0.8 * random.uniform() - 0.4;
      const double input = random.uniform() - 0.5;
      const auto at = [&](std::size_t column, double by) {
        std::vector<double> moved = x, f(size, 0.0), q(size, 0.0);
        moved[column] += by;
        std::vector<Stamps::Slope> slopes;
        equations.evaluate({moved, input, {}}, f, q, slopes);
        f.insert(f.end(), q.begin(), q.end());
        return f;
      };
      std::vector<double> f(size, 0.0), q(size, 0.0);
      std::vector<Stamps::Slope> slopes;
      equations.evaluate({x, input, {}}, f, q, slopes);
      f.insert(f.end(), q.begin(), q.end());
      for (std::size_t column = 0; column < size; ++column) {
        std::vector<double> stated(2 * size, 0.0), scale(2 * size, 0.0);
        for (const Stamps::Slope& one : slopes) {
          if (one.column != static_cast<int>(column)) continue;
          stated[static_cast<std::size_t>(one.row)] += one.f;
          stated[static_cast<std::size_t>(one.row) + size] += one.q;
          scale[static_cast<std::size_t>(one.row)] += std::abs(one.f);
          scale[static_cast<std::size_t>(one.row) + size] += std::abs(one.q);
        }
        constexpr double kStep = 1e-6;
        const std::vector<double> up = at(column, kStep), down = at(column, -kStep);
        for (std::size_t row = 0; row < 2 * size; ++row) {
          const double right = (up[row] - f[row]) / kStep, left = (f[row] - down[row]) / kStep;
          const double rounding = 1e-9 * std::abs(f[row]) + 1e-30;
          if (std::abs(right - left) > 1e-3 * (std::abs(right) + std::abs(left)) + rounding)
            continue;  // a corner
          EXPECT_NEAR(stated[row], 0.5 * (right + left), 1e-4 * scale[row] + rounding)
              << row << " by " << column;
          met += stated[row] != 0.0 ? 1U : 0U;
        }
      }
    }
    EXPECT_GT(met, 3000u);
  }
}

TEST(Netlists, GroupsAreSortedWithTheirElements) {
  Netlist n;
  n.groups = {{"b", Purpose::output}, {"a", Purpose::powers}, {"c", Purpose::output}};
  n.parts = {ohms("R0", "x", "y", 1.0), ohms("R1", "x", "y", 1.0), ohms("R2", "x", "y", 1.0)};
  for (std::size_t i = 0; i < 3; ++i) n.parts[i].group = i;
  sort_groups(n, [](Purpose a, Purpose b) { return a < b; });
  EXPECT_EQ(n.groups[0].title, "a");
  EXPECT_EQ(n.groups[1].title, "b");
  EXPECT_EQ(n.parts[0].group, 1u);
  EXPECT_EQ(n.parts[1].group, 0u);
  EXPECT_EQ(n.parts[2].group, 2u);
  EXPECT_EQ(subset(n, [](std::size_t group) { return group == 1; }).parts.size(), 1u);
}

}  // namespace
}  // namespace bodesmith::schematic
