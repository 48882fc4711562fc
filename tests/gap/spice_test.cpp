// What ngspice measures on decks of op-amps, capacitors, switches, multipliers and diodes, and what the
// search makes of it.
#include <gtest/gtest.h>

#include <cmath>

#include "chain/model_file.hpp"
#include "gap/cases/signals.hpp"
#include "gap/cases/solve.hpp"
#include "gap/cases/spice_cases.hpp"
#include "gap/settle.hpp"
#include "simulate/simulate.hpp"
#include "spice/ngspice.hpp"

namespace {

using namespace bodesmith;
using hidden::Kind;

class Measured : public testing::Test {
 protected:
  void SetUp() override {
    if (!spice::ngspice_available()) GTEST_SKIP() << "ngspice is not installed: nothing to measure with";
  }
  static hidden::Outcome named(Kind kind, const std::string& base, const std::string& what,
                               std::uint64_t seed) {
    return hidden::solve(
        hidden::make_spice_case({hidden::World::ngspice, kind, base, {what}, 10.0, seed, 1500}));
  }
};

// The decks themselves: with nothing hidden they are their models to far below the noise that is added later.
TEST_F(Measured, DecksWithNothingHiddenAreTheirModels) {
  for (const auto& base : hidden::spice_bases()) {
    const auto deck = hidden::make_clean_deck(base, 11, 1000);
    const auto chain = chain::model_from_node(parse_toml(deck.model, "model.toml"));
    simulate::Options options;
    options.start = simulate::Start::equilibrium;  // as ngspice begins
    const auto model = simulate::simulate(chain, deck.record, options).y;
    const auto skip = gap::unscored_samples(chain, deck.record);
    std::vector<double> scored(deck.record.y.begin() + static_cast<std::ptrdiff_t>(skip),
                               deck.record.y.end());
    std::vector<double> error;
    for (std::size_t i = skip; i < model.size(); ++i) error.push_back(model[i] - deck.record.y[i]);
    EXPECT_LT(hidden::rms(error), 1e-3 * hidden::rms(scored)) << base << " leaves out " << skip;
  }
}

TEST_F(Measured, FiniteBandwidthOfASectionsOpAmp) {
  const auto o = named(Kind::effect, "opamp_sections", "opamp_bandwidth", 1);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
  EXPECT_GT(o.closure, 0.8) << hidden::line_of(o);
}

TEST_F(Measured, ACapacitorOff) {
  const auto o = named(Kind::effect, "opamp_sections", "capacitor_mismatch", 2);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
  EXPECT_GT(o.closure, 0.8) << hidden::line_of(o);
}

TEST_F(Measured, ASlewingOpAmp) {
  const auto o = named(Kind::effect, "opamp_gain", "slew_limit", 3);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
}

TEST_F(Measured, AnOutputAtItsRails) {
  const auto o = named(Kind::effect, "opamp_gain", "saturation", 4);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
}

TEST_F(Measured, AMultipliersErrors) {
  const auto o = named(Kind::effect, "multipliers", "multiplier_error", 5);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
}

TEST_F(Measured, ALateSwitch) {
  const auto o = named(Kind::effect, "switched", "switch_delay", 6);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
}

TEST_F(Measured, AHoldOfSwitchAndCapacitor) {
  const auto o = named(Kind::effect, "opamp_gain", "sample_hold", 7);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
}

TEST_F(Measured, NothingHidden) {
  const auto o = named(Kind::control, "opamp_sections", "coloured", 8);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
}

TEST_F(Measured, ADiodeIsNotInTheCatalogue) {
  const auto o = named(Kind::outside, "opamp_gain", "diode", 9);
  EXPECT_TRUE(o.right) << hidden::line_of(o);
}

}  // namespace
