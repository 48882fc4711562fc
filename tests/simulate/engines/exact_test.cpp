// Closed forms against the other engines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "chain/registry.hpp"
#include "simulate/engines/engine.hpp"
#include "simulate/record/exact_propagator.hpp"
#include "simulate/records.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::make_block;

/// The seed's generator and eight poles under a triangle.
Chain seed_chain() {
  Chain chain{{make_block("polynomial_hysteresis")
                   .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                   .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156})}};
  const double zeros[] = {48.79, 14.8, 107.6, 63.68, 380.2, 221.6, 400.0, 365.6};
  const double poles[] = {47.49, 13.99, 126.4, 102.2, 214.9, 124.8, 652.1, 589.4};
  for (int i = 0; i < 8; ++i) {
    chain.blocks.push_back(make_block("pole_zero")
                               .set("zero_hz", zeros[i] / (2.0 * kPi))
                               .set("pole_hz", poles[i] / (2.0 * kPi)));
  }
  return chain;
}

TEST(Engines, ExactRecordAndCvodeAgreeOnTheSeedsChainTo1e9) {
  const auto in = record_of(2001, 0.0005, triangle);
  Options exact;
  exact.engine = Engine::exact;
  for (const auto start : {Start::zero, Start::equilibrium}) {
    exact.start = start;
    const auto got = simulate(seed_chain(), in, exact);
    EXPECT_EQ(got.stats.engine, Engine::exact);
    EXPECT_EQ(got.stats.steps, 8u);
    EXPECT_LT(*got.error_estimate, 1e-10);
    EXPECT_LT(max_difference(got.y, simulate(seed_chain(), in, by_record(1, start)).y), 1e-11);
    EXPECT_LT(max_difference(got.y, simulate(seed_chain(), in, cvode(1e-12, start)).y), 1e-9);
  }
  Options automatic;
  EXPECT_EQ(simulate(seed_chain(), in, automatic).stats.engine, Engine::exact);
  EXPECT_EQ(simulate(seed_chain(), record_of(201, 0.01, two_sines), automatic).stats.engine, Engine::record);
}

TEST(Engines, ExactWithDelayGainAndDrift) {
  Chain chain{{make_block("gain").set("gain", 2.0).set("offset", -0.3),
               make_block("drift").set("rate_per_s", 0.4),
               make_block("polynomial").set("coefficients", std::vector<double>{0.2, 1.0, 0.0, -0.1}),
               make_block("delay").set("delay_s", 0.01234),
               make_block("resonator").set("natural_frequency_hz", 30.0).set("damping_ratio", 0.1),
               make_block("gain").set("gain", -1.5).set("offset", 0.7)}};
  const auto in = record_of(1001, 0.001, triangle, 0.125);
  Options exact;
  exact.engine = Engine::exact;
  for (const auto start : {Start::zero, Start::equilibrium}) {
    exact.start = start;
    EXPECT_LT(max_difference(simulate(chain, in, exact).y, simulate(chain, in, cvode(1e-12, start)).y), 1e-9);
  }
  chain.blocks.push_back(make_block("saturation").set("lower", -1.0).set("upper", 1.0));
  EXPECT_THROW(simulate(chain, in, exact), InputError);
}

// Three whole samples late, though 3 steps of .001 are not .003 to the last digit: from the fourth on it is the input's own.
TEST(ExactEngine, ADelayOfWholeSamplesShiftsBySoMany) {
  const Chain chain{{make_block("gain").set("gain", 2.0), make_block("delay").set("delay_s", 0.003)}};
  const auto in = record_of(50, 0.001, [](double t) { return 1.0 + t; });
  Options exact;
  exact.engine = Engine::exact;
  const auto y = simulate(chain, in, exact).y;
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], i < 3 ? 0.0 : 2.0 * in.u[i - 3], 1e-11) << i;
}

TEST(ExactEngine, LongReferencesAreOneSegmentAHalfPeriod) {
  const Chain chain{{make_block("lowpass").set("corner_hz", 30.0)}};
  // A period of whole samples, and one (97 Hz) whose corners lie between samples: rounding must not cut
  // lines.
  for (const double hertz : {100.0, 97.0}) {
    ReferenceSpec spec;
    spec.frequency = Hertz{hertz};
    spec.step_s = 1e-5;
    Options options;
    options.engine = Engine::exact;
    const Result got = simulate(chain, make_reference(spec), options);
    EXPECT_LE(got.stats.steps, hertz == 100.0 ? 200u : 4u * 97u) << hertz;
    EXPECT_LT(*got.error_estimate, 1e-12);
  }
}

TEST(ExactEngine, SaysWhyThereIsNone) {
  const auto reason_of = [](const Chain& chain, const TimeRecord& in, Engine asked) {
    Options options;
    options.engine = asked;
    const auto got = exact_engine().run(chain, in, options);
    const auto* none = std::get_if<NoClosedForm>(&got);
    return none != nullptr ? none->text : std::string();
  };
  const auto lag = [](double hertz) { return make_block("lowpass").set("corner_hz", hertz); };
  const auto power = [](std::size_t degree) {
    std::vector<double> coefficients(degree + 1, 0.0);
    coefficients.back() = 1.0;
    return make_block("polynomial").set("coefficients", coefficients);
  };
  const TimeRecord lines = record_of(201, 0.005, triangle), curved = record_of(201, 0.005, two_sines);
  const auto switched = make_block("polynomial_hysteresis")
                            .set("ascending", std::vector<double>{0.35, -0.64, 0.29})
                            .set("descending", std::vector<double>{-0.24, 0.08, 0.16});
  // What can never be is told first, wherever it stands and whatever comes in.
  for (const auto& block :
       {make_block("saturation").set("lower", -0.4).set("upper", 0.6),
        make_block("sample_hold").set("clock_hz", 37.0),
        make_block("resonator").set("natural_frequency_hz", 3.0).set("damping_ratio", 0.3).set("cubic", 0.4),
        make_block("backlash").set("width", 0.07), chain::Block(switched).set("switch_delay_s", 1e-3)}) {
    for (const TimeRecord* in : {&lines, &curved}) {
      EXPECT_THAT(reason_of({{block}}, *in, Engine::automatic),
                  testing::HasSubstr("neither linear nor a polynomial"))
          << block.type_name();
      EXPECT_THAT(reason_of({{lag(3.0), block}}, *in, Engine::automatic),
                  testing::HasSubstr("neither linear nor a polynomial"))
          << block.type_name();
    }
  }
  EXPECT_THAT(reason_of({{lag(3.0)}}, record_of(1, 1.0, one), Engine::exact),
              testing::HasSubstr("one sample"));
  EXPECT_THAT(reason_of({{lag(3.0)}}, curved, Engine::automatic),
              testing::HasSubstr("a corner at nearly every sample"));
  EXPECT_EQ(reason_of({{lag(3.0)}}, curved, Engine::exact), "");
  EXPECT_EQ(reason_of({{lag(3.0)}}, lines, Engine::automatic), "");
  const auto lifted = make_block("gain").set("gain", 1.0).set("offset", 0.2);
  EXPECT_THAT(reason_of({{lag(3.0), lifted, lag(5.0)}}, lines, Engine::exact),
              testing::HasSubstr("a constant enters between dynamics"));
  EXPECT_EQ(reason_of({{lifted, lag(3.0), lag(5.0), lifted}}, lines, Engine::exact), "");
  EXPECT_THAT(reason_of({{lag(3.0), power(2)}}, lines, Engine::exact),
              testing::HasSubstr("follows linear dynamics"));
  constexpr std::size_t kMost = ExactPropagator::kMaxInputDegree;
  EXPECT_EQ(reason_of({{power(kMost), lag(3.0)}}, lines, Engine::exact), "");
  EXPECT_THAT(reason_of({{power(kMost), power(2)}}, lines, Engine::exact),
              testing::HasSubstr("too high a degree"));
  EXPECT_EQ(reason_of({{switched, lag(3.0)}}, lines, Engine::exact), "");
  EXPECT_THAT(reason_of({{power(2), switched}}, lines, Engine::exact),
              testing::HasSubstr("turns inside a segment"));
  EXPECT_THAT(reason_of({{lag(3.0), lag(3.0)}}, lines, Engine::exact),
              testing::HasSubstr("nearly equal poles"));
}

}  // namespace
}  // namespace bodesmith::simulate
