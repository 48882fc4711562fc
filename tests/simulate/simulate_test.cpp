// Which engine is chosen, and that its tolerance is met.
#include <gtest/gtest.h>

#include <cmath>

#include "chain/registry.hpp"
#include "simulate/records.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::make_block;

TEST(Engines, AutomaticMeetsItsTolerance) {
  Chain chain{{make_block("lowpass").set("corner_hz", 30.0),
               make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, -0.3, 0.2}),
               make_block("resonator").set("natural_frequency_hz", 25.0).set("damping_ratio", 0.2)}};
  const auto in = record_of(401, 0.0025, two_sines);
  Options options;
  const auto got = simulate(chain, in, options);
  ASSERT_TRUE(got.error_estimate.has_value());
  EXPECT_LT(*got.error_estimate, 1e-7);
  EXPECT_LT(max_difference(got.y, simulate(chain, in, cvode(1e-12)).y), *got.error_estimate + 1e-10);
}

TEST(AutomaticEngine, PicksClosedFormElseSamplesElseEvents) {
  ReferenceSpec spec;
  spec.frequency = Hertz{5.0};
  spec.step_s = 1e-3;
  const TimeRecord u = make_reference(spec);
  const auto lowpass = [](double hertz) { return make_block("lowpass").set("corner_hz", hertz); };
  const auto engine_of = [&](const Chain& chain, double tolerance = 1e-8) {
    Options options;
    options.relative_tolerance = tolerance;
    options.absolute_tolerance = 1e-2 * tolerance;
    const Result got = simulate(chain, u, options);
    EXPECT_TRUE(got.error_estimate);
    // Judged by an independent run, the estimate is honest.
    Options fine;
    fine.engine = Engine::cvode;
    fine.relative_tolerance = 1e-12;
    fine.absolute_tolerance = 1e-14;
    fine.estimate_error = false;
    const auto reference = simulate(chain, u, fine).y;
    double most = 0.0;
    for (std::size_t i = 0; i < reference.size(); ++i)
      most = std::max(most, std::abs(got.y[i] - reference[i]));
    EXPECT_LT(most, 20.0 * *got.error_estimate + 1e-9) << to_string(got.stats.engine);
    EXPECT_LT(most, 1e-6) << to_string(got.stats.engine);
    return got.stats.engine;
  };
  EXPECT_EQ(engine_of(Chain{{lowpass(30.0), lowpass(50.0)}}), Engine::exact);
  EXPECT_EQ(engine_of(Chain{{lowpass(30.0),
                             make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.4}),
                             lowpass(50.0)}}),
            Engine::record);
  // Hysteresis behind a lag turns between samples, where its output has a corner: more and more steps, and
  // in the end events.
  const Chain turning{{lowpass(30.0), make_block("backlash").set("width", 0.07), lowpass(400.0)}};
  EXPECT_EQ(engine_of(turning), Engine::record);
  EXPECT_EQ(engine_of(turning, 1e-11), Engine::cvode);
}

}  // namespace
}  // namespace bodesmith::simulate
