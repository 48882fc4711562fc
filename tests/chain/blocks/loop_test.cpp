// Blocks with the names of parts, and the loop of a controller that is fed by its own drive.

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"

namespace bodesmith::chain {
namespace {

TEST(NamedBlocks, SectionsBearTheirNumbersAndReadBack) {
  Sections sections;
  sections.gain = 1.7;
  sections.sections = {{2.0, {-30.0}, {-10.0}}, {0.5, {-5.0, -900.0}, {-20.0, -300.0}}};
  sections.delay_s = 1e-3;
  const Chain read = model_from_node(parse_toml(model_text(chain_of(sections, "Section")), "model.toml"));
  std::vector<std::string> names;
  for (const Block& block : read.blocks) names.push_back(block.part);
  EXPECT_EQ(names, (std::vector<std::string>{"Section_gain", "Section1", "Section2a", "Section2b",
                                             "Section_delay"}));
  for (const Block& block : chain_of(sections).blocks) EXPECT_TRUE(block.part.empty());
}

TEST(NamedBlocks, LabelsSayTheName) {
  Chain chain;
  chain.blocks = {make_block("lowpass").set("corner_hz", 5.0)};
  chain.blocks[0].part = "amplifier";
  EXPECT_EQ(chain.label(chain.blocks[0].parameters()[0]), "block 1 (lowpass, amplifier) corner_hz");
}

/// v + d(v) = r, by the equation itself.
TEST(LoopBlock, SolvesItsEquationOnBothBranches) {
  const double up[3] = {0.3546, -0.6433, 0.2887};
  const double down[3] = {-0.2398, 0.0838, 0.156};
  Block block = make_block("loop");
  block.set("ascending", std::vector<double>(up, up + 3))
      .set("descending", std::vector<double>(down, down + 3));
  ASSERT_FALSE(block.validate());
  Kernel kernel = block.kernel();
  MemoryKernel& loop = *std::get<std::unique_ptr<MemoryKernel>>(kernel);
  EXPECT_TRUE(loop.has_branches());
  double v = loop.reset(0.0, true);
  EXPECT_NEAR(v, 0.0, 1e-12);
  for (int i = 1; i <= 200; ++i) {
    const double r = i <= 100 ? i / 100.0 : 2.0 - i / 100.0;
    const double* a = i <= 100 ? up : down;
    EXPECT_EQ(loop.peek(r, 1e-3), v = loop.step(r, 1e-3));
    EXPECT_EQ(loop.on_branch(i <= 100, r), v);
    EXPECT_NEAR(v + v * (a[0] + v * (a[1] + v * a[2])), r, 1e-12);
  }
  // One pass is the paper's v = r - d(r).
  block.set("passes", 1.0);
  kernel = block.kernel();
  MemoryKernel& pass = *std::get<std::unique_ptr<MemoryKernel>>(kernel);
  pass.reset(0.0, true);
  EXPECT_NEAR(pass.step(0.5, 1e-3), 0.5 - 0.5 * (up[0] + 0.5 * (up[1] + 0.5 * up[2])), 1e-14);
}

TEST(LoopBlock, ScalesItsReference) {
  Block block = make_block("loop");
  block.set("reference_gain", 1.1)
      .set("ascending", std::vector<double>{0.3, -0.3, 0.0})
      .set("descending", std::vector<double>{0.0, 0.0, 0.0});
  for (const double passes : {0.0, 1.0}) {
    Kernel kernel = block.set("passes", passes).kernel();
    MemoryKernel& loop = *std::get<std::unique_ptr<MemoryKernel>>(kernel);
    loop.reset(0.0, true);
    const double v = loop.step(0.5, 1e-3);
    const double x = passes == 0.0 ? v : 0.5;
    EXPECT_NEAR(v, 1.1 * 0.5 - 0.3 * x * (1.0 - x), 1e-14);
  }
}

/// Of a divider p = R2/(R1 + R2) both resistors, from 5 % to either side, tell any other value exactly.
TEST(PartChange, IsExactForAnyValueOfAResistor) {
  const double r1 = 3.0, r2 = 2.0;
  for (const bool upper : {true, false}) {
    const auto at = [&](double percent) {
      const double factor = 1.0 + percent / 100.0;
      const double top = upper ? r1 * factor : r1, bottom = upper ? r2 : r2 * factor;
      return bottom / (top + bottom);
    };
    PartChange change{upper ? "R1" : "R2", "percent", 1.0, {}};
    change.add("gain", 5.0, at(5.0) - at(0.0), at(-5.0) - at(0.0));
    const Block good = make_block("gain").set("gain", at(0.0));
    for (const double percent : {-60.0, -5.0, 0.0, 8.0, 300.0})
      EXPECT_NEAR(good.with(change, percent).get("gain"), at(percent), 1e-12);
    // The same from blocks; what does not move, or by rounding only, has no entry.
    PartChange same{"R", "percent", 1.0, {}};
    const auto block = [&](double percent) {
      return make_block("resonator")
          .set("gain", at(percent))
          .set("natural_frequency_hz", 100.0 * (1.0 + 1e-13 * percent))
          .set("damping_ratio", 0.5);
    };
    same.add_differences(block(0.0), 5.0, block(5.0), block(-5.0));
    ASSERT_EQ(same.entries.size(), 1u);
    EXPECT_EQ(same.entries[0].parameter, "gain");
    EXPECT_NEAR(same.entries[0].slope, change.entries[0].slope, 1e-15);
    EXPECT_NEAR(same.entries[0].bend, change.entries[0].bend, 1e-15);
  }
  // What moves to one side only (a square) has no such form: the line is taken.
  PartChange square{"M", "v", 1.0, {}};
  square.add("gain", 1.0, 3.0, 1.0);
  EXPECT_EQ(square.entries[0].slope, 1.0);
  EXPECT_EQ(square.entries[0].bend, 0.0);
}

TEST(PartChange, ReadsBackAndNamesAWrongParameter) {
  Chain chain;
  chain.blocks = {make_block("gain").set("gain", 2.0)};
  chain.blocks[0].parts = std::make_shared<const std::vector<PartChange>>(std::vector<PartChange>{
      {"M2, offset of X", "v", 0.009, {{"gain", 0.25, 0.0}}}, {"R1", "percent", 1.0, {}}});
  const std::string text = model_text(chain);
  const Chain read = model_from_node(parse_toml(text, "model.toml"));
  EXPECT_EQ(model_text(read), text);
  EXPECT_EQ(read.blocks[0].parts->at(0).part, "M2, offset of X");
  EXPECT_EQ(read.blocks[0].parts->at(0).entries[0].slope, 0.25);
  std::string wrong = text;
  wrong.replace(wrong.find("\"gain\" = ["), 6, "\"game\"");
  EXPECT_THROW(model_from_node(parse_toml(wrong, "model.toml")), InputError);
}

TEST(PartChange, OfAnOpampReadsBack) {
  Chain chain;
  chain.blocks = {make_block("biquad").set("natural_frequency_hz", 50.0).set("damping_ratio", 0.7)};
  PartChange opamp{.part = "U1"};
  opamp.noise_gain = {1.5, 2.5, 3.5};
  opamp.feedthrough = {-4.5, 0.0, 5.5};
  opamp.gain_bandwidth_hz = 3e6;
  chain.blocks[0].parts = std::make_shared<const std::vector<PartChange>>(std::vector<PartChange>{opamp});
  const std::string text = model_text(chain);
  const Chain read = model_from_node(parse_toml(text, "model.toml"));
  EXPECT_EQ(model_text(read), text);
  EXPECT_EQ(read.blocks[0].parts->at(0).noise_gain, opamp.noise_gain);
  EXPECT_EQ(read.blocks[0].parts->at(0).feedthrough, opamp.feedthrough);
  EXPECT_EQ(read.blocks[0].parts->at(0).gain_bandwidth_hz, 3e6);
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string wrong = text;
    wrong.replace(wrong.find(from), from.size(), to);
    EXPECT_THROW(model_from_node(parse_toml(wrong, "model.toml")), InputError) << to;
  };
  refused("feedthrough = [-4.5, 0", "feedthrough = [-4.5");
  refused("feedthrough = [-4.5", "feed = [-4.5");
  // Only a biquad's numerator can move.
  EXPECT_THROW(
      model_from_node(parse_toml(
          "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 5\n[block.parts]\n"
          "U1 = {gain_bandwidth_hz = 1e6, noise_gain = [1, 2, 0], feedthrough = [1, 0, 0]}\n",
          "model.toml")),
      InputError);
}

TEST(LoopBlock, RefusesAGeneratorWithoutADrive) {
  Block block = make_block("loop");
  block.set("ascending", std::vector<double>{-1.5, 1.5, 0.0})
      .set("descending", std::vector<double>{0.0, 0.0, 0.0});
  EXPECT_TRUE(block.validate());
}

}  // namespace
}  // namespace bodesmith::chain
