// What a fit may change of a base model, and where a term's values go.
#include "gap/model/model.hpp"

#include <gtest/gtest.h>

#include "chain/registry.hpp"
#include "gap/made_model.hpp"

namespace model_of_terms {
namespace {

using namespace bodesmith;

const char* const kBase =
    "[[block]]\ntype = \"gain\"\ngain = -2.0\noffset = 0.0\nfree = [\"gain\", \"offset\"]\n"
    "[[block]]\ntype = \"lowpass\"\ncorner_hz = 40.0\nfree = [\"corner_hz\"]\n";

TEST(GapModel, FreeParametersAreSearchedByTheirSize) {
  gap::Model model(model_of(kBase));
  const auto all = model.unknowns();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].name, "block 1 gain");
  EXPECT_FALSE(all[0].logarithmic) << "it may be below 0";
  EXPECT_EQ(all[0].scale, 2.0);
  EXPECT_EQ(all[0].given, -2.0);
  EXPECT_EQ(all[0].given_spread, 0.5);
  EXPECT_EQ(all[1].name, "block 1 offset");
  EXPECT_EQ(all[1].scale, 1e-3);
  EXPECT_EQ(all[1].given_spread, 0.0) << "of 0 nothing is known";
  EXPECT_TRUE(all[2].logarithmic);
  EXPECT_EQ(all[2].unit, "Hz");
  EXPECT_EQ(all[2].given_spread, 0.25);
  // The size of the signal is that of an offset alone.
  model.set_signal_size(3.0);
  EXPECT_EQ(model.unknowns()[0].scale, 2.0);
  EXPECT_EQ(model.unknowns()[1].scale, 0.75);
  model.set_signal_size(0.0);
  EXPECT_EQ(model.unknowns()[1].scale, 0.75);
  gap::Model offset(model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = 0.5\nfree = [\"offset\"]\n"));
  offset.set_signal_size(3.0);
  EXPECT_EQ(offset.unknowns()[0].scale, 0.5) << "an offset that is given has its own size";
}

/// A delay in front of the second block.
gap::Term delay_of(gap::Model& model, double seconds) {
  gap::Term term;
  const int id = model.insert(1, chain::make_block("delay").set("delay_s", seconds));
  term.blocks = {id};
  gap::Unknown u;
  u.name = "delay_s";
  u.value = seconds;
  term.unknowns = {u};
  term.write = [id](gap::Model& m, std::span<const double> v) { m.block(id).set("delay_s", v[0]); };
  return term;
}

TEST(GapModel, ValuesGoToTheBlocksOfTheBaseAndThenOfTheTerms) {
  gap::Model model(model_of(kBase));
  EXPECT_EQ(model.placed(0), "before block 1");
  EXPECT_EQ(model.placed(1), "before block 2");
  EXPECT_EQ(model.placed(2), "after block 2");
  EXPECT_EQ(gap::Model().placed(0), "at the input");
  model.add(delay_of(model, 0.1));
  model.add(delay_of(model, 0.2));
  EXPECT_EQ(model.size(), 4U);
  EXPECT_EQ(model.free_count(), 3U);
  EXPECT_EQ(model.first_unknown_of(0), 3U);
  EXPECT_EQ(model.first_unknown_of(1), 4U);
  model.set_values(std::vector{-1.0, 0.25, 30.0, 0.3, 0.4});
  const auto blocks = model.chain().blocks;
  EXPECT_EQ(blocks[0].get("gain"), -1.0);
  EXPECT_EQ(blocks[0].get("offset"), 0.25);
  EXPECT_EQ(blocks[1].get("delay_s"), 0.4) << "the later one was put in front";
  EXPECT_EQ(blocks[2].get("delay_s"), 0.3);
  EXPECT_EQ(blocks[3].get("corner_hz"), 30.0);
  EXPECT_EQ(model.base_number(3), 2);
  EXPECT_EQ(model.base_number(1), 0);
  EXPECT_TRUE(model.is_base(0));
  EXPECT_FALSE(model.is_base(2));
  model.move_term(0, 1);
  EXPECT_EQ(model.terms()[0].unknowns[0].value, 0.4);
  model.remove(0);
  ASSERT_EQ(model.size(), 3U);
  EXPECT_EQ(model.at(1).get("delay_s"), 0.3);
  EXPECT_EQ(model.end(), 3U);
  EXPECT_TRUE(model.validation_error().empty());
  model.set_values(std::vector{-1.0, 0.25, -30.0, 0.3});
  EXPECT_FALSE(model.validation_error().empty());
}

}  // namespace
}  // namespace model_of_terms
