// The response of a board with several clocks against a run of its difference equations, edge by edge.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/multirate_response.hpp"
#include "fpaa/plan.hpp"
#include "plan_simulation.hpp"

namespace bodesmith::fpaa {
namespace {

PlacedCam low_pass_at(const char* name, double clock, int cin, int cint, int cout) {
  PlacedCam out;
  out.name = name;
  out.cam = cam_registry().find("FilterBilinear");
  out.option = "Low Pass";
  out.clock_a = {clock};
  out.capacitors = {{"Cin", cin}, {"Cint", cint}, {"Cout", cout}};
  out.z = {{-1.0 * cin}, {1.0 * (cout + cint), -1.0 * cint}};
  return out;
}

PlacedCam sum_at(const char* name, double clock, std::vector<double> weights) {
  PlacedCam out;
  out.name = name;
  out.cam = cam_registry().find("SumDiff");
  out.clock_a = {clock};
  out.z = {{-weights[0]}, {1.0}};
  for (std::size_t i = 1; i < weights.size(); ++i) out.more_numerators.push_back({-weights[i]});
  return out;
}

/// Divisors 2·k of 16 MHz, so that common periods stay short.
Plan three_clock_plan(double fast_divisor) {
  Plan plan;
  plan.board = "an231k04-quad4";
  ChipPlan chip{1, {16e6}, {}, {}};
  chip.cams.push_back(low_pass_at("A", 16e6 / 480, 30, 40, 12));
  chip.cams.push_back(low_pass_at("B", 16e6 / 360, 20, 90, 11));
  chip.cams.push_back(sum_at("S", 16e6 / fast_divisor, {0.7, 0.4, -0.2}));
  plan.chips = {chip};
  plan.wires = {{"chip1.in1", "chip1.A"},  {"chip1.in1", "chip1.B"},  {"chip1.in1", "chip1.S", 1},
                {"chip1.A", "chip1.S", 2}, {"chip1.B", "chip1.S", 3}, {"chip1.S", "chip1.out1"}};
  plan.path = {"chip1.in1", "chip1.S", "chip1.out1"};
  return plan;
}

void expect_agreement(const Plan& plan, std::initializer_list<double> frequencies) {
  const MultirateResponse response(plan);
  for (const double f : frequencies) {
    const auto ticked = simulated_fundamental(plan, {f}, 0.004, 0.0005);
    const auto exact = response.as_it_runs(Hertz{f}.rad_s());
    EXPECT_NEAR(std::abs(ticked - exact), 0.0, 1e-6 * std::abs(exact)) << f << " Hz";
  }
}

TEST(Multirate, ParallelPathsAtTheirOwnClocks) {
  expect_agreement(three_clock_plan(40), {123.0, 1000.0, 7777.0, 16000.0, 30000.0});
  expect_agreement(three_clock_plan(28), {123.0, 20000.0});  // no clock divides another
  expect_agreement(three_clock_plan(600), {500.0});          // the sum is the slowest
}

TEST(Multirate, LinesFoldBackThroughAFastStage) {
  // Slow, fast, slow again: the second slow filter reads just the samples that the first made.
  Plan plan = three_clock_plan(40);
  plan.chips[0].cams[1].clock_a = {16e6 / 480};
  plan.wires = {
      {"chip1.in1", "chip1.A"}, {"chip1.A", "chip1.S", 1}, {"chip1.S", "chip1.B"}, {"chip1.B", "chip1.out1"}};
  expect_agreement(plan, {100.0, 3000.0, 12000.0});
  const MultirateResponse response(plan);
  const double w = Hertz{3000.0}.rad_s().value;
  const auto product = plan.chips[0].cams[0].z.response({w}, {16e6 / 480}) *
                       plan.chips[0].cams[1].z.response({w}, {16e6 / 480}) * -0.7 *
                       zero_order_hold({w}, {16e6 / 480});
  EXPECT_NEAR(std::abs(response.as_it_runs({w}) - product), 0.0, 1e-12);

  plan.chips[0].cams[1].clock_a = {16e6 / 320};  // a filter with memory in between, three clocks deep
  plan.chips[0].cams[2] = low_pass_at("S", 16e6 / 48, 7, 5, 6);
  expect_agreement(plan, {100.0, 3000.0, 12000.0});
}

TEST(Multirate, DelaysOnTop) {
  for (const double cycles : {0.5, 1.0, 1.5}) {
    Plan plan = three_clock_plan(40);
    plan.chips[0].cams[0].delay_cycles = cycles;
    plan.chips[0].cams[2].delay_cycles = 0.5;
    expect_agreement(plan, {123.0, 9000.0});
    plan.chips[0].cams[0].clock_a = plan.chips[0].cams[2].clock_a;
    expect_agreement(plan, {123.0, 9000.0});
  }
}

TEST(Multirate, OneClockIsTheProductAndOneHold) {
  Plan plan = three_clock_plan(480);
  plan.wires = {{"chip1.in1", "chip1.A"}, {"chip1.A", "chip1.S"}, {"chip1.S", "chip1.out1"}};
  const RadPerSecond w = Hertz{800.0}.rad_s();
  const Hertz clock{16e6 / 480};
  const auto product = plan.chips[0].cams[0].z.response(w, clock) * -0.7;
  EXPECT_NEAR(std::abs(plan_response(plan, w, false) - product), 0.0, 1e-14);
  EXPECT_NEAR(std::abs(plan_response(plan, w, true) - product * zero_order_hold(w, clock)), 0.0, 1e-12);
}

TEST(Multirate, WiresAndNumeratorsReadBack) {
  const Plan plan = three_clock_plan(40);
  Json json = json_header("fpaa_plan", {});
  json.update(plan.to_json());
  EXPECT_EQ(json["wires"].size(), 6u);
  EXPECT_EQ(json["chips"][0]["cams"][2]["z_numerators"].size(), 3u);
  const Plan back = Plan::from_node(parse_json(to_text(json), "plan.json"));
  const RadPerSecond w = Hertz{777.0}.rad_s();
  EXPECT_EQ(plan_response(back, w, true), plan_response(plan, w, true));
}

TEST(Multirate, WrongWiresAreNamed) {
  const auto refusal = [](const Wire& wire) {
    Plan plan = three_clock_plan(40);
    plan.wires.push_back(wire);
    const Outcome<PlanGraph> graph = plan_graph(plan);
    return refusal_of(graph) != nullptr ? refusal_of(graph)->reason : std::string();
  };
  EXPECT_NE(refusal({"chip1.in1", "chip1.A"}).find("two wires"), std::string::npos);
  EXPECT_NE(refusal({"chip1.in1", "chip1.A", 2}).find("input 2"), std::string::npos);
  EXPECT_NE(refusal({"chip1.in1", "chip1.X"}).find("chip1.X"), std::string::npos);

  Plan plan = three_clock_plan(40);
  plan.wires[4].from = "chip2.out1";  // nothing leads there
  const Outcome<PlanGraph> graph = plan_graph(plan);
  ASSERT_NE(refusal_of(graph), nullptr);
  EXPECT_NE(refusal_of(graph)->reason.find("chip2.out1"), std::string::npos);
}

TEST(Multirate, LoopsRunWhereSomethingReadsLate) {
  // y[n] = x[n] - 0.5 y[n-1]: the impulse response alternates.
  Plan plan;
  plan.board = "an231k04-quad4";
  ChipPlan chip{1, {16e6}, {}, {sum_at("S", 1e6, {-1.0, 0.5}), sum_at("D", 1e6, {-1.0})}};
  chip.cams[1].delay_cycles = 1.0;
  plan.chips = {chip};
  plan.wires = {{"chip1.in1", "chip1.S", 1},
                {"chip1.S", "chip1.D"},
                {"chip1.D", "chip1.S", 2},
                {"chip1.S", "chip1.out1"}};
  const auto impulse = [](double t) { return t == 0.0 ? 1.0 : 0.0; };
  PlanSimulation run(plan, impulse);
  for (int n = 0; n < 8; ++n) EXPECT_NEAR(run.output_v(32 * n), std::pow(-0.5, n), 1e-12);
  plan.chips[0].cams[1].delay_cycles = 0.0;
  EXPECT_THROW(PlanSimulation(plan, impulse), DesignError);
}

}  // namespace
}  // namespace bodesmith::fpaa
