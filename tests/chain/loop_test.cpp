// Blocks with the names of parts, and the loop of a controller that is fed by its own drive.

#include <gtest/gtest.h>

#include <cmath>

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
  chain.blocks[0].free("corner_hz");
  EXPECT_EQ(chain.label(*chain.free_parameters()[0]), "block 1 (lowpass, amplifier) corner_hz");
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
  double v = loop.reset(0.0, true);
  EXPECT_NEAR(v, 0.0, 1e-12);
  for (int i = 1; i <= 200; ++i) {
    const double r = i <= 100 ? i / 100.0 : 2.0 - i / 100.0;
    const double* a = i <= 100 ? up : down;
    EXPECT_EQ(loop.peek(r, 1e-3), v = loop.step(r, 1e-3));
    EXPECT_NEAR(v + v * (a[0] + v * (a[1] + v * a[2])), r, 1e-12);
  }
  // One pass is the paper's v = r - d(r).
  block.set("passes", 1.0);
  kernel = block.kernel();
  MemoryKernel& pass = *std::get<std::unique_ptr<MemoryKernel>>(kernel);
  pass.reset(0.0, true);
  EXPECT_NEAR(pass.step(0.5, 1e-3), 0.5 - 0.5 * (up[0] + 0.5 * (up[1] + 0.5 * up[2])), 1e-14);
}

TEST(LoopBlock, RefusesAGeneratorWithoutADrive) {
  Block block = make_block("loop");
  block.set("ascending", std::vector<double>{-1.5, 1.5, 0.0})
      .set("descending", std::vector<double>{0.0, 0.0, 0.0});
  EXPECT_TRUE(block.validate());
}

}  // namespace
}  // namespace bodesmith::chain
