// A new block type is one object and one registration: everything of this room then knows it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "base/error.hpp"
#include "chain/bent_block.hpp"
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
}

}  // namespace
}  // namespace bodesmith::chain
