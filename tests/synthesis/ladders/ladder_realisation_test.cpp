#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "schematic/analysis/equations.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/ladders/alternating_chains.hpp"
#include "synthesis/ladders/rc_ladder.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/seed_sections.hpp"

namespace bodesmith::synthesis {
namespace {

const RcLadder* const kTestedLadders[] = {&foster1(), &foster2(), &cauer1(), &cauer2()};

RcImpedance half_order(int pairs) {
  RcImpedance z;
  z.high = 1e4;
  for (int i = 0; i < pairs; ++i) {
    z.poles.push_back(10.0 * std::pow(10.0, i));
    z.zeros.push_back(31.0 * std::pow(10.0, i));
  }
  return z;
}

/// A term of order 1/2 as sections of one pole and one zero; `lag`: falling.
Sections term(int pairs, bool lag, double gain = 1.0) {
  Sections out;
  const RcImpedance z = half_order(pairs);
  for (int i = 0; i < pairs; ++i) {
    Section one;
    one.poles = {-(lag ? z.poles : z.zeros)[static_cast<size_t>(i)]};
    one.zeros = {-(lag ? z.zeros : z.poles)[static_cast<size_t>(i)]};
    out.sections.push_back(one);
  }
  out.gain = gain;
  return out;
}

TEST(Ladder, FourFormsAreTheSameImpedance) {
  for (const int pairs : {1, 2, 5, 8}) {
    const RcImpedance z = half_order(pairs);
    for (const RcLadder* form : kTestedLadders) {
      const std::vector<LadderPart> parts = form->parts(z);
      ASSERT_EQ(parts.size(), 2U * static_cast<size_t>(pairs) + 1U);
      std::vector<double> values;
      schematic::Netlist network;
      const auto grounded = [](const std::string& node) { return node == "b" ? "0" : node; };
      for (const LadderPart& part : parts) {
        EXPECT_GT(part.value, 0.0) << part.name;
        values.push_back(part.value);
        network.parts.push_back({part.resistor ? Part::Kind::resistor : Part::Kind::capacitor, part.name, "",
                                 0, grounded(part.from), grounded(part.to), "exact", part.value, part.value});
      }
      const schematic::Equations equations(network);
      for (double w = 1.0; w < 1e10; w *= 30.0) {
        const std::complex<double> s(0.0, w), wanted = z(s);
        // Nodal analysis knows nothing of the forms.
        EXPECT_LT(std::abs(equations.ways_to({w}, "a")(equations.node("a")) / wanted - 1.0), 1e-7);
        EXPECT_LT(std::abs(form->impedance(values, s) / wanted - 1.0), 1e-7);
      }
      const RcImpedance back = impedance_of(parts);
      EXPECT_NEAR(back.high / z.high, 1.0, 1e-9);
      for (size_t i = 0; i < z.poles.size(); ++i) {
        EXPECT_NEAR(back.poles[i] / z.poles[i], 1.0, 1e-7);
        EXPECT_NEAR(back.zeros[i] / z.zeros[i], 1.0, 1e-7);
      }
    }
  }
}

TEST(Ladder, CornersAreGroupedIntoAlternatingChains) {
  const auto chains = alternating_chains({1, 10, 100}, {3, 30, 300});
  ASSERT_EQ(chains.size(), 1U);
  EXPECT_TRUE(chains[0].lag);
  EXPECT_EQ(chains[0].zeros, (std::vector<double>{3, 30, 300}));
  // Two equal lags one above the other in slope: two chains. A lone end of each kind makes a pair.
  for (const auto& [poles, zeros] : std::vector<std::pair<std::vector<double>, std::vector<double>>>{
           {{1, 1.1, 10, 11}, {3, 3.3, 30, 33}}, {{1, 2, 3}, {10, 20, 30}}, {{5, 6, 1}, {2, 3, 50}}}) {
    size_t count = 0;
    for (const AlternatingChain& chain : alternating_chains(poles, zeros)) {
      ASSERT_EQ(chain.poles.size(), chain.zeros.size());
      count += chain.poles.size();
      for (size_t i = 0; i < chain.poles.size(); ++i) {
        EXPECT_EQ(chain.poles[i] < chain.zeros[i], chain.lag);
        if (i > 0) {
          EXPECT_GT((chain.lag ? chain.poles : chain.zeros)[i],
                    (chain.lag ? chain.zeros : chain.poles)[i - 1]);
        }
      }
    }
    EXPECT_EQ(count, poles.size());
  }
}

TEST(Ladder, CircuitMakesTheTerm) {
  for (const bool lag : {true, false}) {
    for (const char* form : {"foster1", "foster2", "cauer1", "cauer2"}) {
      SCOPED_TRACE(form);
      RealiseOptions options;
      options.realisation = form;
      options.limits.max_ohm = 1e7;
      options.limits.max_f = 10e-6;
      options.limits.min_f = 10e-12;
      options.resistors = options.capacitors = Series::named("exact");
      const Sections wanted = term(4, lag, lag ? 2.0 : -0.3);
      const Realised exact = realise(wanted, options);
      EXPECT_LT(exact.report.parts.max_complex_percent, 1e-6);
      // The network's own solution agrees with the stages' poles and zeros.
      const auto grid = log_grid(exact.report.band, 40);
      const auto network = schematic::network_response(exact.circuit, grid, {.ideal_opamps = true}),
                 own = exact.circuit.responses(grid);
      EXPECT_LT(compare_responses(grid, network, own).max_complex_percent, 1e-6);
      // E96 and E12: searched, and better than rounded.
      options.resistors = Series::named("E96");
      options.capacitors = Series::named("E12");
      const Realised made = realise(wanted, options);
      EXPECT_LT(made.report.parts.max_magnitude_db, 0.15);
      EXPECT_LT(made.report.parts.max_complex_percent, made.report.nearest.max_complex_percent);
      const auto again = schematic::network_response(made.circuit, grid, {.ideal_opamps = true}),
                 stages = made.circuit.responses(grid);
      EXPECT_LT(compare_responses(grid, again, stages).max_complex_percent, 1e-6);
      for (const Part& part : made.circuit.parts) {
        const bool resistor = part.kind == Part::Kind::resistor;
        EXPECT_GE(part.realised, resistor ? options.limits.min_ohm : options.limits.min_f) << part.name;
        EXPECT_LE(part.realised, resistor ? options.limits.max_ohm : options.limits.max_f) << part.name;
      }
    }
  }
}

TEST(Ladder, OneOpAmpForEveryChain) {
  RealiseOptions options;
  options.realisation = "foster1";
  options.limits = realisation_registry().get("foster1").usual_limits();
  const Realised made = realise(seed_sections(), options);
  EXPECT_LE(made.circuit.opamps.size(), 6U);  // eight and an inverter as first-order stages
  EXPECT_LT(made.report.parts.max_magnitude_db, 0.1);
}

TEST(Ladder, WhatItCannotMakeIsSaid) {
  RealiseOptions options;
  options.realisation = "cauer1";
  Sections complex;
  complex.sections.push_back({1.0, {{-1, 2}, {-1, -2}}, {{-3, 0}, {-4, 0}}});
  EXPECT_THROW(realise(complex, options), DesignError);
  Sections uneven;
  uneven.sections.push_back({1.0, {}, {{-3, 0}}});
  EXPECT_THROW(realise(uneven, options), DesignError);
  Sections right;
  right.sections.push_back({1.0, {{3, 0}}, {{-3, 0}}});
  EXPECT_THROW(realise(right, options), DesignError);
  EXPECT_THROW(realise(Sections{}, options), DesignError);
  options.limits.min_ohm = 1e4;
  options.limits.max_ohm = 2e4;
  EXPECT_THROW(realise(term(6, true), options), DesignError);
}

}  // namespace
}  // namespace bodesmith::synthesis
