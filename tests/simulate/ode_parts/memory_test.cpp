// The chain runs the hysteresis room's operators as they are, and both engines agree on them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "chain/blocks/hysteresis.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "simulate/record/record_simulator.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

TimeRecord wave() {
  TimeRecord r;
  r.step_s = 1e-3;
  for (int i = 0; i <= 1500; ++i) {
    const double t = 1e-3 * i;
    r.u.push_back(0.5 + 0.3 * std::sin(2.0 * std::numbers::pi * 2.0 * t) +
                  0.15 * std::sin(2.0 * std::numbers::pi * 7.0 * t));
  }
  return r;
}

std::vector<Block> blocks() {
  return {make_block("prandtl_ishlinskii")
              .set("r", std::vector<double>{0.0, 0.05, 0.1, 0.2})
              .set("w", std::vector<double>{1.0, 0.2, 0.1, 0.05}),
          make_block("bouc_wen").set("k", 1.0).set("A", 0.5).set("beta", 1.3).set("gamma", 0.9),
          make_block("krasnoselskii_pokrovskii")
              .set("u_min", 0.0)
              .set("u_max", 1.0)
              .set("mu", std::vector<double>(10, 0.1)),
          make_block("preisach")
              .set("u_min", 0.0)
              .set("u_max", 1.0)
              .set("w", std::vector<double>(36, 1.0 / 36.0))};
}

double largest(std::span<const double> a, std::span<const double> b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

TEST(HysteresisBlocks, AreTheirOperators) {
  const TimeRecord in = wave();
  for (const Block& block : blocks()) {
    SCOPED_TRACE(block.type_name());
    ASSERT_FALSE(block.validate().has_value());
    // Through model.toml and back, then against the operator itself.
    const Chain chain = chain::model_from_node(parse_toml(chain::model_text(Chain{{block}}), "model.toml"));
    Options options;
    options.engine = Engine::record;
    options.start = Start::equilibrium;
    options.estimate_error = false;
    const auto y = simulate(chain, in, options).y;
    const auto op = hysteresis::make_operator(chain::hysteresis_model_of(block));
    std::vector<double> wanted = {op->reset(in.u[0])};
    for (std::size_t i = 1; i < in.size(); ++i) wanted.push_back(op->step(in.u[i], in.step_s));
    EXPECT_LT(largest(y, wanted), 1e-12);
    Options cvode = options;
    cvode.engine = Engine::cvode;
    EXPECT_LT(largest(simulate(chain, in, cvode).y, wanted), 1e-9);
  }
}

TEST(HysteresisBlocks, BetweenLagsBothEnginesAgree) {
  const TimeRecord in = wave();
  for (const Block& block : blocks()) {
    SCOPED_TRACE(block.type_name());
    // Sums of relays jump; the smooth ones and those with kinks are compared.
    const bool relays = block.type_name() == "preisach";
    const Chain chain{
        {make_block("lowpass").set("corner_hz", 20.0), block, make_block("lowpass").set("corner_hz", 40.0)}};
    Options fine;
    fine.engine = Engine::record;
    fine.oversample = 16;
    fine.start = Start::equilibrium;
    fine.estimate_error = false;
    Options cvode = fine;
    cvode.engine = Engine::cvode;
    cvode.relative_tolerance = 1e-7;
    cvode.absolute_tolerance = 1e-9;
    EXPECT_LT(largest(simulate(chain, in, fine).y, simulate(chain, in, cvode).y), relays ? 1e-3 : 2e-5);
  }
}

TEST(HysteresisBlocks, ParametersCanBeRefitted) {
  Block play = blocks()[0];
  RecordSimulator simulator(Chain{{play}}, 1e-3);
  const TimeRecord in = wave();
  const std::vector<double> before(simulator.run(in.u).begin(), simulator.run(in.u).end());
  simulator.chain().blocks[0].set("w[1]", 0.4);
  const auto after = simulator.run(in.u);
  play.set("w[1]", 0.4);
  RecordSimulator fresh(Chain{{play}}, 1e-3);
  EXPECT_EQ(largest(after, fresh.run(in.u)), 0.0);
  EXPECT_GT(largest(after, before), 0.01);
}

}  // namespace
}  // namespace bodesmith::simulate
