// What each kind of compensator is at one frequency.
#include "tracking/compensator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace bodesmith::tracking {
namespace {

using namespace std::complex_literals;

TEST(Compensator, AClockedOneHoldsAndDelays) {
  ClockedCompensator c;
  c.clock = Hertz{1e3};
  c.gain = 2.0;
  c.sections = {{{1.0, 1.0}, {2.0}}};  // the mean of two samples
  const RadPerSecond w = Hertz{100.0}.rad_s();
  c.hold_and_delays = false;
  const auto mean = 2.0 * 0.5 * (1.0 + std::exp(-1i * w.value * 1e-3));
  EXPECT_LT(std::abs(compensator_response(c, w) - mean), 1e-14);
  EXPECT_EQ(clocked_part(c), nullptr);
  c.hold_and_delays = true;
  c.delay_cycles = 0.5;
  const double half = 0.5 * w.value * 1e-3;
  const auto held = mean * std::sin(half) / half * std::exp(-1i * half) * std::exp(-1i * w.value * 0.5e-3);
  const Compensator held_one = c;
  EXPECT_LT(std::abs(compensator_response(held_one, w) - held), 1e-14);
  EXPECT_NE(clocked_part(held_one), nullptr);
}

TEST(Compensator, AScheduledGainSettlesOnItsTable) {
  const ScheduledGain schedule{{Hertz{1.0}, Hertz{100.0}}, {1.0, 2.0}};
  const auto at = [&](double f) { return std::get<ConstantGain>(settled_at(schedule, Hertz{f})).gain; };
  EXPECT_DOUBLE_EQ(at(0.1), 1.0);
  EXPECT_DOUBLE_EQ(at(10.0), 1.5);
  EXPECT_DOUBLE_EQ(at(1e4), 2.0);
  EXPECT_DOUBLE_EQ(std::get<ConstantGain>(settled_at(ConstantGain{3.0}, Hertz{1.0})).gain, 3.0);
}

}  // namespace
}  // namespace bodesmith::tracking
