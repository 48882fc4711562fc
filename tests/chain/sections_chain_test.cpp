// Sections as blocks: the same response, by the blocks' own formulas and by their states.
#include "chain/sections_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

using Complex = std::complex<double>;

/// gain prod (s - z)/prod (s - p) of all sections, written out here once more.
Complex by_definition(const Sections& sections, Complex s) {
  Complex out = sections.gain * std::exp(-s * sections.delay_s);
  for (const Section& section : sections.sections) {
    out *= section.gain;
    for (const Complex& zero : section.zeros) out *= s - zero;
    for (const Complex& pole : section.poles) out /= s - pole;
  }
  return out;
}

Complex by_states(const Chain& chain, Complex s) {
  Complex out = 1.0;
  for (const Block& block : chain.blocks) out *= response(std::get<LinearKernel>(block.kernel()), s);
  return out;
}

void expect_same(const Section& section, double tolerance = 1e-12) {
  Sections sections;
  sections.gain = -0.7;
  sections.delay_s = 1e-3;
  sections.sections = {section};
  const Chain chain = chain_of(sections);
  for (const double hz : {0.03, 1.0, 7.0, 300.0, 4e4}) {
    const Complex s(0.0, Hertz{hz}.rad_s().value);
    const Complex wanted = by_definition(sections, s);
    const Complex formula = *chain.response(Hertz{hz}.rad_s());
    EXPECT_LT(std::abs(formula - wanted), tolerance * std::abs(wanted)) << hz;
    EXPECT_LT(std::abs(by_states(chain, s) - wanted), 10.0 * tolerance * std::abs(wanted) + 1e-13) << hz;
  }
}

TEST(SectionsChain, EveryKindOfRootsIsTheSameResponse) {
  const Complex high(-30.0, 200.0);
  const Complex notch(-1.0, 150.0);
  expect_same({2.0, {}, {-40.0}});
  expect_same({2.0, {0.0}, {-40.0}});
  expect_same({2.0, {-9.0}, {-40.0}});
  expect_same({2.0, {9.0}, {-40.0}});
  expect_same({2.0, {-3.0}, {0.0}});
  expect_same({2.0, {}, {0.0}});
  expect_same({2.0, {-3.0, -500.0}, {0.0, -4000.0}});
  expect_same({2.0, {-3.0}, {-70.0, -4000.0}});
  expect_same({2.0, {}, {high, std::conj(high)}});
  expect_same({2.0, {0.0}, {high, std::conj(high)}});
  expect_same({2.0, {5.0}, {high, std::conj(high)}});
  expect_same({2.0, {0.0, 0.0}, {high, std::conj(high)}});
  expect_same({2.0, {0.0, -8.0}, {high, std::conj(high)}});
  expect_same({2.0, {-80.0, 60.0}, {high, std::conj(high)}});
  expect_same({2.0, {notch, std::conj(notch)}, {high, std::conj(high)}});
  expect_same({2.0, {notch, std::conj(notch)}, {-20.0, -900.0}});
  expect_same({2.0, {notch, std::conj(notch)}, {0.0, -900.0}}, 1e-8);
}

TEST(SectionsChain, NothingButAGainIsAGain) {
  Sections sections;
  sections.gain = 3.0;
  const Chain chain = chain_of(sections);
  ASSERT_EQ(chain.blocks.size(), 1u);
  EXPECT_EQ(chain.blocks[0].get("gain"), 3.0);
}

TEST(SectionsChain, TwoIntegratorsBelowComplexZerosAreRefused) {
  Sections sections;
  sections.sections = {{1.0, {Complex(-1.0, 5.0), Complex(-1.0, -5.0)}, {0.0, 0.0}}};
  EXPECT_THROW(chain_of(sections), InputError);
}

// y = u + K(f) d(u/alpha)...: the gains at the operating frequency, strokes of the table.
TEST(SectionsChain, AStageIsItsDisturbance) {
  Disturbance d;
  d.ascending = {0.1, -0.1, 0.0};
  d.descending = {0.3, -0.3, 0.0};
  d.rate.frequency = {Hertz{1.0}, Hertz{10.0}};
  d.rate.ascending = {1.0, 1.0};
  d.rate.descending = {1.0, 1.5};
  const Block stage = stage_block(d, Hertz{10.0});
  EXPECT_EQ(stage.part, "stage");
  EXPECT_FALSE(stage.validate().has_value());
  auto kernel = std::get<std::unique_ptr<MemoryKernel>>(stage.kernel());
  kernel->reset(0.0, true);
  for (const double u : {0.25, 0.5, 0.75, 1.0})
    EXPECT_NEAR(kernel->step(u, 1e-3), u + 0.1 * u * (1.0 - u), 1e-12);
  for (const double u : {0.6, 0.2}) {
    EXPECT_NEAR(kernel->peek(u, 1e-3), u + 1.5 * 0.3 * u * (1.0 - u), 1e-12);
    EXPECT_NEAR(kernel->step(u, 1e-3), u + 1.5 * 0.3 * u * (1.0 - u), 1e-12);
  }
}

TEST(SectionsChain, CascadesTermsAreNamedInTheirOrder) {
  Cascade cascade;
  cascade.gain = 2.0;
  cascade.terms = {{0.1, 0.5, 0.3}, {0.01, 3.0, -0.7}};
  const Chain chain = chain_of(cascade);
  ASSERT_EQ(chain.blocks.size(), 3u);
  EXPECT_EQ(chain.blocks[0].part, "gain");
  EXPECT_EQ(chain.blocks[1].part, "Term1");
  EXPECT_EQ(chain.blocks[2].part, "Term2");
  const RadPerSecond w{30.0};
  EXPECT_LT(std::abs(*chain.response(w) / cascade.response(w) - 1.0), 1e-12);
}

}  // namespace
}  // namespace bodesmith::chain
