#include <gtest/gtest.h>

#include "base/document.hpp"
#include "base/error.hpp"
#include "lti/sections.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::circuit {
namespace {

/// (1 + s/100)/s, times 50.
Sections pi_controller() {
  Sections out;
  Section one;
  one.gain = 0.5;
  one.zeros = {{-100.0, 0.0}};
  one.poles = {{0.0, 0.0}};
  out.sections = {one};
  return out;
}

TEST(Integrator, AnOpAmpWithRAndCInSeriesMakesIt) {
  for (const bool zero : {true, false}) {
    Sections wanted = pi_controller();
    if (!zero) wanted.sections[0].zeros.clear();
    if (!zero) wanted.sections[0].gain = 50.0;
    const Realised made = realise(wanted);
    for (const double hz : {0.5, 5.0, 50.0, 500.0}) {
      const RadPerSecond w = Hertz{hz}.rad_s();
      EXPECT_NEAR(std::abs(made.circuit.response(w) / wanted.response(w) - 1.0), 0.0, 0.02) << hz;
    }
    // With the op-amps' own equations too.
    const auto real = schematic::network_response(made.circuit, {Hertz{5.0}}).front();
    EXPECT_NEAR(std::abs(real / wanted.response(Hertz{5.0}.rad_s()) - 1.0), 0.0, 0.02);
  }
}

/// A PID of a slow loop has complex zeros over its pole at 0 and that of its derivative.
TEST(Integrator, TwoIntegratorsWithoutALoopMakeAPid) {
  Sections wanted;
  Section pid;
  pid.gain = 1.3;
  pid.zeros = {{-5.6, 41.8}, {-5.6, -41.8}};
  pid.poles = {{0.0, 0.0}, {-188.5, 0.0}};
  wanted.sections = {pid};
  const Realised made = realise(wanted);
  for (const double hz : {0.1, 1.0, 4.0, 20.0, 100.0}) {
    const RadPerSecond w = Hertz{hz}.rad_s();
    EXPECT_NEAR(std::abs(made.circuit.response(w) / wanted.response(w) - 1.0), 0.0, 0.05) << hz;
  }
  const auto real = schematic::network_response(made.circuit, {Hertz{20.0}}).front();
  EXPECT_NEAR(std::abs(real / wanted.response(Hertz{20.0}.rad_s()) - 1.0), 0.0, 0.05);
}

TEST(Integrator, SectionsMayHaveAPoleAtZeroAndNowhereElseOnTheAxis) {
  const auto sections = [](const std::string& poles) {
    return Sections::from_node(parse_json(
        R"({"schema":"bodesmith.sections/1","sections":[{"zeros_rad_s":[],"poles_rad_s":)" + poles + "}]}",
        "s.json"));
  };
  EXPECT_TRUE(integrates(sections("[[0,0]]")));
  EXPECT_TRUE(std::isinf(sections("[[0,0]]").dc_gain()));
  EXPECT_FALSE(integrates(sections("[[-1,0]]")));
  EXPECT_THROW(sections("[[1,0]]"), InputError);
  EXPECT_THROW(sections("[[0,5],[0,-5]]"), InputError);
}

}  // namespace
}  // namespace bodesmith::circuit
