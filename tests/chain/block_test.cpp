// A new block type is one object and one registration: everything of this room then knows it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "base/error.hpp"
#include "chain/bent_block.hpp"
#include "chain/inverse.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"

namespace bodesmith::chain {
namespace {

const BentType& bent_block() {
  static const BentType type("bent_in_chain_test");
  return type;
}

TEST(NewBlock, IsReadWrittenAndRefusedLikeAnyOther) {
  block_type_registry().add(bent_block());
  const std::string head = "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"bent_in_chain_test\"\n";
  const Chain chain =
      model_from_node(parse_toml(head + "amount = 0.25\nfree = [\"amount\"]\n", "model.toml"));
  ASSERT_EQ(chain.blocks.size(), 1u);
  EXPECT_EQ(chain.blocks[0].get("amount"), 0.25);
  EXPECT_EQ(chain.blocks[0].parameters()[0].unit(), "1/u");
  EXPECT_EQ(std::get<std::unique_ptr<CurveKernel>>(chain.blocks[0].kernel())->value(2.0), 2.5);
  EXPECT_EQ(model_text(model_from_node(parse_toml(model_text(chain), "model.toml"))), model_text(chain));
  EXPECT_EQ(make_block("bent_in_chain_test").get("amount"), 0.5);
  EXPECT_THROW(model_from_node(parse_toml(head + "amount = 0\n", "model.toml")), InputError);
  // Where nothing else is said a block is no section, no delay, no straight line.
  EXPECT_EQ(chain.blocks[0].section_order(), 0);
  EXPECT_EQ(chain.blocks[0].slowest_time_constant_s(), 0.0);
  EXPECT_FALSE(chain.blocks[0].scales_only());
  EXPECT_THROW(block_type_registry().add(bent_block()), std::logic_error);
  EXPECT_THROW(make_block("no such block"), InputError);
}

TEST(Blocks, SayThemselvesWhatOthersAsk) {
  EXPECT_TRUE(make_block("gain").set("gain", 3.0).scales_only());
  EXPECT_FALSE(make_block("gain").set("offset", 1.0).scales_only());
  EXPECT_EQ(make_block("gain").set("offset", 1.0).affine()->constant, 1.0);
  EXPECT_DOUBLE_EQ(make_block("delay").set("delay_s", 0.7).slowest_time_constant_s(), 0.1);
  EXPECT_EQ(make_block("lowpass").section_order(), 1);
  EXPECT_EQ(make_block("resonator").section_order(), 2);
  EXPECT_EQ(make_block("creep").section_order(), 0);
  EXPECT_EQ(
      make_block("creep").set("time_constants_s", std::vector<double>{1.0, 30.0}).slowest_time_constant_s(),
      30.0);
  // An overdamped resonator's slower pole: (zeta - sqrt(zeta^2 - 1)) w.
  EXPECT_NEAR(make_block("resonator")
                  .set("natural_frequency_hz", 1.0)
                  .set("damping_ratio", 2.0)
                  .slowest_time_constant_s(),
              1.0 / (2.0 * 3.14159265358979 * (2.0 - std::sqrt(3.0))), 1e-12);
  EXPECT_EQ(make_block("polynomial").polynomials()[0].first, 1u);
  constexpr double kTau = 1.0 / (2.0 * 3.14159265358979);
  EXPECT_NEAR(make_block("highpass").set("corner_hz", 4.0).slowest_time_constant_s(), kTau / 4.0, 1e-12);
  EXPECT_NEAR(make_block("pole_zero").set("zero_hz", 1.0).set("pole_hz", 5.0).slowest_time_constant_s(),
              kTau / 5.0, 1e-12);
  EXPECT_NEAR(make_block("biquad")
                  .set("natural_frequency_hz", 2.0)
                  .set("damping_ratio", 0.1)
                  .slowest_time_constant_s(),
              kTau / 2.0 / 0.1, 1e-12);
  EXPECT_EQ(make_block("fractional_lead_lag").set("lambda_s", 3.0).set("x", 2.0).slowest_time_constant_s(),
            6.0);
  EXPECT_EQ(make_block("fractional_lead_lag").set("lambda_s", 3.0).set("x", 0.5).slowest_time_constant_s(),
            3.0);
  for (const char* type : {"highpass", "integrator"}) EXPECT_EQ(make_block(type).section_order(), 1) << type;
  for (const char* type : {"biquad", "parallel_modes"})
    EXPECT_EQ(make_block(type).section_order(), 2) << type;
  EXPECT_FALSE(make_block("bouc_wen").set("n", 1.0).steps_within_samples());
  EXPECT_TRUE(make_block("bouc_wen").set("n", 1.5).steps_within_samples());
  EXPECT_EQ(make_block("polynomial_hysteresis").polynomials().size(), 2u);
  EXPECT_THROW(make_block("gain").get("gian"), std::logic_error);
  EXPECT_THROW(make_block("gain").set("gian", 1.0), std::logic_error);
  EXPECT_THROW(make_block("polynomial").set("gian", std::vector<double>{1.0}), std::logic_error);
}

// y = 3 10^(-6 .5/20) u + .1 .5
TEST(Blocks, AControlVoltageSetsAGainInDecibels) {
  const Block block = make_block("voltage_controlled_gain")
                          .set("gain", 3.0)
                          .set("control_v", 0.5)
                          .set("slope_db_per_v", -6.0)
                          .set("control_feedthrough", 0.1);
  const Kernel kernel = block.kernel();
  const auto& linear = std::get<LinearKernel>(kernel);
  EXPECT_DOUBLE_EQ(linear.d, 3.0 * std::pow(10.0, -0.15));
  EXPECT_DOUBLE_EQ(linear.offset, 0.05);
  EXPECT_DOUBLE_EQ(block.response(RadPerSecond{7.0})->real(), linear.d);
}

// g r = v + d(v) on the branch of v's direction: the reference for a wanted drive, sample by sample.
TEST(Blocks, ALoopsInverseIsItsEquation) {
  Block loop = make_block("loop");
  loop.set("reference_gain", 2.0)
      .set("ascending", std::vector<double>{0.1, -0.1, 0.0})
      .set("descending", std::vector<double>{0.3, -0.3, 0.0})
      .set("constant_descending", 0.01);
  const WantedOutput wanted{0.0, 1e-3, {0.0, 0.2, 0.6, 1.0, 0.7, 0.1}};
  const auto found = loop.inverse(wanted);
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->out_of_reach.empty());
  for (std::size_t i = 1; i < wanted.values.size(); ++i) {
    const double v = wanted.values[i], d = (i < 4 ? 0.1 : 0.3) * v * (1.0 - v) + (i < 4 ? 0.0 : 0.01);
    EXPECT_NEAR(found->values[i], (v + d) / 2.0, 1e-12) << i;
  }
  // Forth and back.
  auto kernel = std::get<std::unique_ptr<MemoryKernel>>(loop.kernel());
  EXPECT_NEAR(kernel->reset(found->values[0], true), 0.0, 1e-12);
  for (std::size_t i = 1; i < wanted.values.size(); ++i)
    EXPECT_NEAR(kernel->step(found->values[i], 1e-3), wanted.values[i], 1e-9) << i;
  EXPECT_TRUE(kernel->rate_independent());
  EXPECT_FALSE(loop.set("passes", 1.0).inverse(wanted).has_value());
  EXPECT_TRUE(loop.set("passes", 1.5).validate().has_value());
}

// A hold hears half a period late and passes what stands still.
TEST(Blocks, AHoldsInverseLooksAheadByHalfAPeriod) {
  Block hold = make_block("sample_hold");
  hold.set("clock_hz", 100.0);
  WantedOutput wanted{0.0, 1e-3, {}};
  for (int i = 0; i < 40; ++i) wanted.values.push_back(0.1 * i);
  const auto found = hold.inverse(wanted);
  ASSERT_TRUE(found.has_value());
  for (std::size_t i = 0; i < 30; ++i)
    EXPECT_NEAR(found->values[i], 0.1 * (static_cast<double>(i) + 5.0), 1e-9) << i;
  EXPECT_NEAR(found->values.back(), 3.9, 1e-12);
}

TEST(Blocks, WhatHasNoInverseSaysSo) {
  const WantedOutput wanted{0.0, 1e-3, {0.0, 1.0, 2.0}};
  EXPECT_FALSE(make_block("gain").set("gain", 0.0).inverse(wanted).has_value());
  EXPECT_EQ(make_block("gain").set("gain", 4.0).set("offset", 1.0).inverse(wanted)->values[2], 0.25);
  Block relays = make_block("preisach");
  relays.set("u_min", 0.0).set("u_max", 1.0).set("w", std::vector<double>{1.0});
  relays.set_word("interpolation", "relays");
  EXPECT_FALSE(relays.inverse(wanted).has_value());
}

TEST(Blocks, AnOpampsRailsAreInOrder) {
  Block opamp = make_block("opamp");
  opamp.set("gain_bandwidth_hz", 1e6)
      .set("slew_rate_v_per_s", 1e6)
      .set("lower_rail_v", -5.0)
      .set("upper_rail_v", 5.0);
  EXPECT_FALSE(opamp.validate().has_value());
  EXPECT_TRUE(opamp.set("lower_rail_v", 5.0).validate().has_value());
}

}  // namespace
}  // namespace bodesmith::chain
