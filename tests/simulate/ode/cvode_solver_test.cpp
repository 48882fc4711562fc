// Long and stiff chains in CVODE: the Newton solver walks along the chain instead of factorising a matrix.
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

TimeRecord triangle_record(double step_s) {
  ReferenceSpec spec;
  spec.frequency = Hertz{2.0};
  spec.step_s = step_s;
  return make_reference(spec);
}

TEST(StiffChain, SectionsPassTheirInputOnAndAreStillSolved) {
  // Poles from 0.5 Hz to 50 kHz, each passed on by all behind it: df/dx is a full triangle.
  Chain chain;
  for (int i = 0; i < 40; ++i) {
    const double pole = 0.5 * std::pow(10.0, 5.0 * i / 39.0);
    chain.blocks.push_back(make_block("pole_zero").set("pole_hz", pole).set("zero_hz", 1.04 * pole));
  }
  const TimeRecord u = triangle_record(1e-3);
  const Result got = simulate(chain, u, cvode(1e-8));
  Options exact;
  exact.engine = Engine::exact;
  EXPECT_LT(max_difference(got.y, simulate(chain, u, exact).y), 2e-7);
  // BDF, not steps of the fastest pole (3e5 of them); a wrong Newton matrix would need many evaluations.
  EXPECT_LT(got.stats.steps, 5000u);
  EXPECT_LT(got.stats.evaluations, 4u * got.stats.steps);
}

TEST(StiffChain, NonlinearDynamicsCurvesAndMemoryInSeries) {
  const Chain chain{{make_block("lowpass").set("corner_hz", 20000.0),
                     make_block("polynomial_hysteresis")
                         .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                         .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156}),
                     make_block("fractional_lead_lag").set("lambda_s", 0.02).set("x", 0.1).set("beta", 0.7),
                     make_block("polynomial").set("coefficients", std::vector<double>{0.1, 1.0, 0.3}),
                     make_block("resonator")
                         .set("natural_frequency_hz", 5000.0)
                         .set("damping_ratio", 0.9)
                         .set("cubic", 0.4),
                     make_block("saturation").set("lower", 0.0).set("upper", 0.9),
                     make_block("lowpass").set("corner_hz", 3.0)}};
  const TimeRecord u = triangle_record(1e-3);
  const Result coarse = simulate(chain, u, cvode(1e-7));
  const Result fine = simulate(chain, u, cvode(1e-10));
  EXPECT_LT(max_difference(coarse.y, fine.y), 5e-6);
  Options record;
  record.engine = Engine::record;
  record.oversample = 64;
  record.estimate_error = false;
  EXPECT_LT(max_difference(fine.y, simulate(chain, u, record).y), 2e-6);
  EXPECT_LT(coarse.stats.evaluations, 8u * coarse.stats.steps);
}

}  // namespace
}  // namespace bodesmith::simulate
