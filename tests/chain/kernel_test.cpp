// What every kernel of a kind keeps, whatever the block: slopes are derivatives, rest is rest, a look ahead changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>

#include "chain/inverse.hpp"
#include "chain/opamp_poles.hpp"
#include "chain/registry.hpp"

namespace bodesmith::chain {
namespace {

using List = std::vector<double>;

Block opamp() {
  return make_block("opamp")
      .set("gain", 4.0)
      .set("gain_bandwidth_hz", 1e5)
      .set("slew_rate_v_per_s", 2e4)
      .set("lower_rail_v", -3.0)
      .set("upper_rail_v", 5.0);
}
Block bent_resonator() {
  return make_block("resonator")
      .set("gain", 1.3)
      .set("natural_frequency_hz", 5.0)
      .set("damping_ratio", 0.2)
      .set("quadratic", 0.1)
      .set("cubic", 0.05)
      .set("drag", 0.02);
}

std::vector<double> rates(const OdeKernel& kernel, const List& x, double u) {
  const StateSpace& s = kernel.linear();
  const double n = kernel.nonlinear(x.data(), u);
  std::vector<double> out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double sum = s.b[i] * u + kernel.entry()[i] * n + (s.constant.empty() ? 0.0 : s.constant[i]);
    for (std::size_t j = 0; j < x.size(); ++j) sum += s.a[i * x.size() + j] * x[j];
    out.push_back(sum);
  }
  return out;
}

/// Curves without memory make of the input found what was wanted, either side of 0; what no input gives is told.
TEST(KernelLaws, InversesOfCurvesGiveWhatWasWanted) {
  const WantedOutput wanted{0.0, 0.01, {-0.7, -0.2, 0.0, 0.1, 0.45, 0.9}};
  for (const Block& block : {make_block("dead_zone").set("width", 0.3),
                             make_block("saturation").set("lower", -0.5).set("upper", 0.6),
                             make_block("polynomial").set("coefficients", List{0.1, -1.0, 0.05, -0.03}),
                             make_block("multiplier").set("scale_v", 0.4).set("x_offset_v", -0.2)}) {
    const Kernel kernel = block.kernel();
    const auto* const curve = std::get_if<std::unique_ptr<CurveKernel>>(&kernel);
    ASSERT_NE(curve, nullptr) << block.type_name();
    const auto found = block.inverse(wanted);
    ASSERT_TRUE(found) << block.type_name();
    for (std::size_t i = 0; i < wanted.values.size(); ++i) {
      const double off = (*curve)->value(found->values[i]) - wanted.values[i];
      const bool told =
          std::find(found->out_of_reach.begin(), found->out_of_reach.end(), i) != found->out_of_reach.end();
      EXPECT_EQ(std::abs(off) > 1e-9, told) << block.type_name() << " " << wanted.values[i] << " " << off;
    }
  }
}

TEST(KernelLaws, GradientsOfDynamicsAreDifferences) {
  for (const Block& block : {opamp(), bent_resonator()}) {
    const Kernel made = block.kernel();
    const OdeKernel& kernel = *std::get<std::unique_ptr<OdeKernel>>(made);
    const std::size_t n = kernel.linear().order();
    for (const double u : {-0.9, 0.1, 1.4}) {
      List x(n, 0.0);
      for (std::size_t i = 0; i < n; ++i) x[i] = 0.7 - 1.1 * static_cast<double>(i) + 0.3 * u;
      List by_x(n, 0.0);
      const double by_u = kernel.nonlinear_gradient(x.data(), u, by_x.data());
      constexpr double kStep = 1e-6;
      const auto difference = [&](double& at, double input_step) {
        const double before = at;
        at = before + (input_step == 0.0 ? kStep : 0.0);
        const double up = kernel.nonlinear(x.data(), u + input_step);
        at = before - (input_step == 0.0 ? kStep : 0.0);
        const double down = kernel.nonlinear(x.data(), u - input_step);
        at = before;
        return (up - down) / (2.0 * kStep);
      };
      const double size = 1.0 + std::abs(kernel.linear().a[n * n - 1]);
      for (std::size_t i = 0; i < n; ++i)
        EXPECT_NEAR(by_x[i], difference(x[i], 0.0), 1e-5 * (size + std::abs(by_x[i])))
            << block.type_name() << i;
      EXPECT_NEAR(by_u, difference(x[0], kStep), 1e-5 * (size + std::abs(by_u))) << block.type_name();
    }
  }
}

TEST(KernelLaws, DynamicsAtRestStandStill) {
  for (const Block& block : {opamp(), bent_resonator()}) {
    const Kernel made = block.kernel();
    const OdeKernel& kernel = *std::get<std::unique_ptr<OdeKernel>>(made);
    const std::size_t n = kernel.linear().order();
    for (const double u : {-2.0, -0.5, 0.0, 0.8, 1.25, 2.0}) {
      List x(n, 0.0);
      kernel.equilibrium(u, x.data());
      for (const double rate : rates(kernel, x, u)) EXPECT_NEAR(rate, 0.0, 1e-6) << block.type_name() << u;
    }
  }
}

// y' = SR tanh(w (u - y/G)/SR): the slope at once after a step, and the rail's clamp beyond it.
TEST(KernelLaws, AnOpAmpMovesAsItsEquationSays) {
  const Kernel made = opamp().kernel();
  const OdeKernel& kernel = *std::get<std::unique_ptr<OdeKernel>>(made);
  const double open = 2.0 * M_PI * 1e5, slew = 2e4;
  const auto speed = [&](double y, double u) {
    return kernel.linear().c[0] * rates(kernel, {y / 4.0}, u)[0];
  };
  for (const double u : {0.0, 0.01, 0.03, 1.0})
    EXPECT_NEAR(speed(1.0, u), slew * std::tanh(open * (u - 0.25) / slew), 1e-9 * slew) << u;
  const double clamp = 30.0 * open / 4.0;
  EXPECT_NEAR(speed(5.1, 2.0), slew * std::tanh(open * (2.0 - 1.275) / slew) - 0.1 * clamp, 1e-6 * clamp);
  EXPECT_NEAR(speed(-3.2, -2.0), slew * std::tanh(open * (-2.0 + 0.8) / slew) + 0.2 * clamp, 1e-6 * clamp);
}

TEST(KernelLaws, SlopesOfCurvesAreDifferences) {
  for (const Block& block : {make_block("saturation").set("lower", -0.7).set("upper", 1.1),
                             make_block("dead_zone").set("width", 0.6),
                             make_block("polynomial").set("coefficients", List{0.1, 1.0, -0.4, 0.3}),
                             make_block("multiplier")
                                 .set("scale_v", 1.7)
                                 .set("x_offset_v", 0.02)
                                 .set("y_offset_v", -0.03)
                                 .set("feedthrough", 0.01)}) {
    const Kernel made = block.kernel();
    const CurveKernel& curve = *std::get<std::unique_ptr<CurveKernel>>(made);
    for (double u = -1.93; u < 2.0; u += 0.117)
      EXPECT_NEAR(curve.slope(u), (curve.value(u + 1e-6) - curve.value(u - 1e-6)) / 2e-6, 1e-6)
          << block.type_name() << " at " << u;
    for (const double corner : curve.corners())
      EXPECT_NE(curve.slope(corner - 1e-9), curve.slope(corner + 1e-9)) << block.type_name() << corner;
  }
  const Kernel zone = make_block("dead_zone").set("width", 0.6).kernel();
  const CurveKernel& dead = *std::get<std::unique_ptr<CurveKernel>>(zone);
  EXPECT_EQ(dead.value(0.29), 0.0);
  EXPECT_NEAR(dead.value(0.8), 0.5, 1e-15);
  EXPECT_NEAR(dead.value(-0.8), -0.5, 1e-15);
}

TEST(KernelLaws, RatesOfSourcesAreDifferences) {
  for (const Block& block :
       {make_block("drift").set("rate_per_s", 0.3),
        make_block("hum").set("amplitude", 0.2).set("frequency_hz", 50.0).set("phase_deg", 30.0)}) {
    const Kernel made = block.kernel();
    const SourceKernel& source = *std::get<std::unique_ptr<SourceKernel>>(made);
    for (const double t : {0.0, 1e-3, 0.7, 12.3})
      EXPECT_NEAR(source.rate(t), (source.value(t + 1e-6) - source.value(t - 1e-6)) / 2e-6, 1e-6)
          << block.type_name() << t;
    WantedOutput wanted{0.4, 0.01, {1.0, 2.0, -1.0}};
    const auto inverse = block.inverse(wanted);
    ASSERT_TRUE(inverse);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(inverse->values[i] + source.value(0.4 + 0.01 * static_cast<double>(i)), wanted.values[i],
                  1e-14);
  }
  // Straight between its own points, every octave of it.
  const Kernel pink = make_block("noise")
                          .set("density_per_rthz", 0.1)
                          .set("bandwidth_hz", 137.0)
                          .set("corner_hz", 50.0)
                          .kernel();
  const SourceKernel& noise = *std::get<std::unique_ptr<SourceKernel>>(pink);
  for (const double t : {1e-3, 0.7, 12.3})
    EXPECT_NEAR(noise.rate(t) / ((noise.value(t + 1e-6) - noise.value(t - 1e-6)) / 2e-6), 1.0, 1e-5) << t;
  const Kernel hum =
      make_block("hum").set("amplitude", 0.2).set("frequency_hz", 50.0).set("phase_deg", 30.0).kernel();
  EXPECT_NEAR(std::get<std::unique_ptr<SourceKernel>>(hum)->value(0.0), 0.1, 1e-12);
}

TEST(KernelLaws, ALookAheadChangesNothing) {
  for (const Block& block :
       {make_block("backlash").set("width", 0.5),
        make_block("comparator").set("threshold_v", 0.2).set("hysteresis_v", 0.3).set("low_v", -1.0),
        make_block("slew_limit").set("rate_per_s", 30.0)}) {
    Kernel made = block.kernel();
    MemoryKernel& kernel = *std::get<std::unique_ptr<MemoryKernel>>(made);
    kernel.reset(0.1, true);
    std::vector<double> first;
    for (int i = 0; i < 60; ++i) {
      const double u = std::sin(0.37 * i) * (1.0 - 0.01 * i);
      const double seen = kernel.peek(u, 0.01);
      EXPECT_EQ(kernel.step(u, 0.01), seen) << block.type_name() << i;
      first.push_back(seen);
    }
    // Whatever the time it takes, where that is said.
    kernel.reset(0.1, true);
    bool same = true;
    for (int i = 0; i < 60; ++i)
      same = kernel.step(std::sin(0.37 * i) * (1.0 - 0.01 * i), 3.0) == first[static_cast<std::size_t>(i)] &&
             same;
    EXPECT_EQ(same, kernel.rate_independent()) << block.type_name();
  }
}

TEST(KernelLaws, AComparatorSwitchesAtItsLevels) {
  Kernel made =
      make_block("comparator").set("threshold_v", 0.2).set("hysteresis_v", 0.4).set("low_v", -1.0).kernel();
  MemoryKernel& kernel = *std::get<std::unique_ptr<MemoryKernel>>(made);
  EXPECT_EQ(kernel.reset(0.0, true), -1.0);
  EXPECT_EQ(kernel.reset(0.3, true), 1.0);
  for (const auto& [u, y] : {std::pair{0.01, 1.0}, {-0.01, -1.0}, {0.39, -1.0}, {0.41, 1.0}, {0.01, 1.0}}) {
    EXPECT_EQ(kernel.step(u, 1e-3), y) << u;
  }
  ASSERT_EQ(kernel.corners().size(), 2u);
  EXPECT_DOUBLE_EQ(kernel.corners()[0], 0.0);
  EXPECT_DOUBLE_EQ(kernel.corners()[1], 0.4);
}

TEST(KernelLaws, ABacklashFollowsHalfItsWidthBehind) {
  Kernel made = make_block("backlash").set("width", 0.5).kernel();
  MemoryKernel& play = *std::get<std::unique_ptr<MemoryKernel>>(made);
  EXPECT_EQ(play.reset(0.0, true), 0.0);
  EXPECT_EQ(play.step(0.2, 1.0), 0.0);
  EXPECT_NEAR(play.step(1.0, 1.0), 0.75, 1e-15);
  EXPECT_NEAR(play.step(0.6, 1.0), 0.75, 1e-15);
  EXPECT_NEAR(play.step(-1.0, 1.0), -0.75, 1e-15);
}

// (1 + 0.5 z^-1)/(2 - 0.6 z^-1 + 0.1 z^-2): the recursion itself.
TEST(KernelLaws, AClockedSectionIsItsRecursion) {
  const auto block = make_block("switched_capacitor")
                         .set("clock_hz", 1e4)
                         .set("z_numerator", List{1.0, 0.5})
                         .set("z_denominator", List{2.0, -0.6, 0.1})
                         .set("half_cycle", 1.0);
  Kernel made = block.kernel();
  SampledKernel& kernel = *std::get<std::unique_ptr<SampledKernel>>(made);
  EXPECT_DOUBLE_EQ(kernel.clock_hz(), 1e4);
  EXPECT_DOUBLE_EQ(kernel.delay_s(), 0.5e-4);
  EXPECT_DOUBLE_EQ(mean_delay_s(kernel), 1e-4);
  EXPECT_EQ(kernel.reset(3.0, false), 0.0);
  double u1 = 0.0, y1 = 0.0, y2 = 0.0;
  for (int i = 0; i < 20; ++i) {
    const double u = std::sin(1.3 * i) + 0.5;
    const double y = (u + 0.5 * u1 + 0.6 * y1 - 0.1 * y2) / 2.0;
    EXPECT_NEAR(kernel.update(u), y, 1e-14) << i;
    u1 = u;
    y2 = y1;
    y1 = y;
  }
  // At rest under 2: gain 1.5/1.5 = 1, and it stays.
  EXPECT_NEAR(kernel.reset(2.0, true), 2.0, 1e-14);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(kernel.update(2.0), 2.0, 1e-14);
  EXPECT_NEAR(gain_at_rest(kernel), 1.0, 1e-14);
  Kernel holds = make_block("sample_hold").set("clock_hz", 50.0).set("half_cycle", 1.0).kernel();
  SampledKernel& hold = *std::get<std::unique_ptr<SampledKernel>>(holds);
  EXPECT_DOUBLE_EQ(hold.delay_s(), 0.01);
  EXPECT_EQ(hold.reset(2.0, true), 2.0);
  EXPECT_EQ(hold.reset(2.0, false), 0.0);
}

// Its capacitor's noise is kT/C twice, another at every sample, and the same again from the start.
TEST(KernelLaws, AClockedSectionsNoiseIsThatOfItsCapacitor) {
  Kernel made = make_block("switched_capacitor")
                    .set("clock_hz", 1e4)
                    .set("z_numerator", List{1.0})
                    .set("z_denominator", List{1.0})
                    .set("noise_capacitor_f", 1e-12)
                    .set("temperature_k", 310.0)
                    .kernel();
  SampledKernel& kernel = *std::get<std::unique_ptr<SampledKernel>>(made);
  constexpr int kSamples = 20000;
  double squares = 0.0, sum = 0.0;
  kernel.reset(0.0, false);
  const double first = kernel.update(0.0);
  for (int i = 0; i < kSamples; ++i) {
    const double y = kernel.update(0.0);
    squares += y * y;
    sum += y;
  }
  const double variance = 2.0 * 1.380649e-23 * 310.0 / 1e-12;
  EXPECT_NEAR(squares / kSamples / variance, 1.0, 0.05);
  EXPECT_LT(std::abs(sum) / kSamples, 4.0 * std::sqrt(variance / kSamples));
  kernel.reset(0.0, false);
  EXPECT_EQ(kernel.update(0.0), first);
}

TEST(KernelLaws, TheInverseOfAPolynomialIsOnTheBranchThatReachesMost) {
  // y = u - u^3/3 turns at -1 and 1: between them it reaches -2/3 to 2/3, beyond them all.
  const std::vector<double> c = {0.0, 1.0, 0.0, -1.0 / 3.0};
  const auto at = [&](double u) { return u - u * u * u / 3.0; };
  WantedOutput inside{0.0, 1.0, {-0.5, 0.0, 0.3, 0.6}};
  const FoundInput near = inverse_of_polynomial(c, inside);
  EXPECT_TRUE(near.out_of_reach.empty());
  for (std::size_t i = 0; i < inside.values.size(); ++i) {
    EXPECT_LE(std::abs(near.values[i]), 1.0);
    EXPECT_NEAR(at(near.values[i]), inside.values[i], 1e-14);
  }
  // Most of them below -2/3: the falling branch on the right, on which 0.7 is out of reach.
  WantedOutput low{0.0, 1.0, {-5.0, -3.0, -1.0, 0.7}};
  const FoundInput far = inverse_of_polynomial(c, low);
  EXPECT_EQ(far.out_of_reach, std::vector<std::size_t>{3});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE(far.values[i], 1.0);
    EXPECT_NEAR(at(far.values[i]), low.values[i], 1e-13);
  }
  EXPECT_NEAR(far.values[3], 1.0, 1e-12);
  // A curve that falls throughout.
  const FoundInput falling = inverse_of_polynomial({1.0, -2.0}, {0.0, 1.0, {-1e6, 0.0, 7.0}});
  EXPECT_NEAR(falling.values[0], 500000.5, 1e-9);
  EXPECT_NEAR(falling.values[1], 0.5, 1e-14);
  EXPECT_NEAR(falling.values[2], -3.0, 1e-14);
}

TEST(KernelLaws, LookingAheadIsBetweenTheSamples) {
  const WantedOutput wanted{0.0, 0.1, {0.0, 1.0, 4.0, 9.0}};
  const FoundInput ahead = looking_ahead(wanted, 0.125);
  EXPECT_NEAR(ahead.values[0], 1.75, 1e-12);
  EXPECT_NEAR(ahead.values[1], 5.25, 1e-12);
  EXPECT_EQ(ahead.values[2], 9.0);
  EXPECT_EQ(ahead.values[3], 9.0);
  WantedOutput blind = wanted;
  blind.preview = false;
  EXPECT_EQ(looking_ahead(blind, 0.125).values, wanted.values);
  // Where a slope is too steep for its limit a line at the limit stands.
  const auto slow =
      make_block("slew_limit").set("rate_per_s", 10.0).inverse({0.0, 0.1, {0.0, 0.5, 3.0, 2.9}});
  EXPECT_EQ(slow->out_of_reach, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(slow->values[1], 0.5);
  EXPECT_NEAR(slow->values[2], 1.5, 1e-15);
  EXPECT_NEAR(slow->values[3], 2.5, 1e-15);
  // An op-amp's rails are the limits of what it can make.
  WantedOutput beyond{0.0, 1e-3, {0.0, 1.0, 6.0, -4.0, 2.0}};
  EXPECT_EQ(opamp().inverse(beyond)->out_of_reach, (std::vector<std::size_t>{2, 3}));
}

/// Of whole arrays, of no multiple of the vectors' length too, a curve makes what it makes of each number.
TEST(KernelLaws, CurvesOfArraysAreThoseOfTheirNumbers) {
  for (const Block& block : {make_block("dead_zone").set("width", 0.6),
                             make_block("saturation").set("lower", -0.7).set("upper", 1.1),
                             make_block("polynomial").set("coefficients", List{0.1, 1.0, -0.4, 0.3})}) {
    const Kernel made = block.kernel();
    const CurveKernel& curve = *std::get<std::unique_ptr<CurveKernel>>(made);
    List u, y(13, NAN);
    for (int i = 0; i < 12; ++i) u.push_back(0.31 * (i - 5) + 0.01);
    curve.values(u.data(), y.data(), u.size());
    for (std::size_t i = 0; i < u.size(); ++i)
      EXPECT_NEAR(y[i], curve.value(u[i]), 1e-15) << block.type_name();
    curve.values(u.data(), y.data(), 7);
    EXPECT_NEAR(y[6], curve.value(u[6]), 1e-15) << block.type_name();
    EXPECT_TRUE(std::isnan(y[12])) << block.type_name();
  }
}

TEST(KernelLaws, TheInverseOfABacklashGoesItsHalfWidthAhead) {
  const Block block = make_block("backlash").set("width", 0.3);
  const WantedOutput wanted{0.0, 0.01, {0.2, 0.2, 0.5, 0.9, 0.9, 0.4, -0.6, -0.5}};
  const auto found = block.inverse(wanted);
  ASSERT_TRUE(found);
  Kernel made = block.kernel();
  MemoryKernel& play = *std::get<std::unique_ptr<MemoryKernel>>(made);
  EXPECT_EQ(play.reset(found->values[0], true), wanted.values[0]);
  for (std::size_t i = 1; i < wanted.values.size(); ++i)
    EXPECT_NEAR(play.step(found->values[i], 0.01), wanted.values[i], 1e-15) << i;
  EXPECT_NEAR(play.reset(0.1, false), 0.0, 1e-15);  // within the play of 0
  EXPECT_NEAR(play.reset(0.4, false), 0.25, 1e-15);
}

// y'' + 2 zeta w y' + w^2 (y + quadratic y^2 + cubic y^3) + drag w |y'| y' = gain w^2 u, solved for u.
TEST(KernelLaws, TheInverseOfABentSpringIsItsForce) {
  const double gain = 1.3, w = 2.0 * M_PI * 5.0, zeta = 0.4, quadratic = 0.3, cubic = 0.2, drag = 60.0;
  const Block block = make_block("resonator")
                          .set("gain", gain)
                          .set("natural_frequency_hz", 5.0)
                          .set("damping_ratio", zeta)
                          .set("quadratic", quadratic)
                          .set("cubic", cubic)
                          .set("drag", drag);
  WantedOutput wanted{0.0, 1e-3, {}};
  wanted.smoothing = 1e-9;
  const double turn = 2.0 * M_PI * 0.5;
  for (int i = 0; i < 4000; ++i) wanted.values.push_back(0.5 * std::sin(turn * 1e-3 * i));
  const auto found = block.inverse(wanted);
  ASSERT_TRUE(found);
  for (std::size_t i = 500; i < 3500; i += 50) {
    const double t = 1e-3 * static_cast<double>(i), y = wanted.values[i];
    const double rate = 0.5 * turn * std::cos(turn * t);
    const double u = (-turn * turn * y / (w * w) + 2.0 * zeta * rate / w +
                      y * (1.0 + y * (quadratic + y * cubic)) + drag * std::abs(rate) * rate / w) /
                     gain;
    EXPECT_NEAR(found->values[i], u, 1e-3) << t;
  }
  EXPECT_FALSE(Block(block).set("gain", 0.0).inverse(wanted));
}

// Along a straight line drag is one force, drag |v| v/(gain w), from the first sample to the last.
TEST(KernelLaws, TheInverseOfDragIsOneForceAlongALine) {
  const Block bent = make_block("resonator")
                         .set("gain", 2.0)
                         .set("natural_frequency_hz", 10.0)
                         .set("damping_ratio", 0.1)
                         .set("quadratic", 0.05);
  Block dragged = bent;
  dragged.set("drag", 0.3);
  for (const double v : {4.0, -4.0}) {
    const WantedOutput line{0.0, 0.01, {0.1, 0.1 + 0.01 * v, 0.1 + 0.02 * v, 0.1 + 0.03 * v}};
    const auto without = bent.inverse(line), with = dragged.inverse(line);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(with->values[i] - without->values[i],
                  0.3 * std::abs(v) * v / (2.0 * Hertz{10.0}.rad_s().value), 1e-12)
          << i;
  }
}

/// Poles just inside the unit circle are taken, just outside refused, whatever the others are.
TEST(KernelLaws, AClockedSectionsPolesAreInsideTheUnitCircle) {
  for (const double angle : {0.0, 0.3, 1.4, 2.5, M_PI}) {
    for (const double radius : {0.3, 0.98, 1.02}) {
      for (const List& others : {List{1.0}, List{1.0, 0.6}, List{2.0, -0.7, 0.3, -0.05}}) {
        const List pair = angle == 0.0 || angle == M_PI
                              ? List{1.0, -radius * std::cos(angle)}
                              : List{1.0, -2.0 * radius * std::cos(angle), radius * radius};
        List product(pair.size() + others.size() - 1, 0.0);
        for (std::size_t i = 0; i < pair.size(); ++i) {
          for (std::size_t k = 0; k < others.size(); ++k) product[i + k] += pair[i] * others[k];
        }
        const Block block = make_block("switched_capacitor")
                                .set("clock_hz", 1e4)
                                .set("z_numerator", List{1.0})
                                .set("z_denominator", product);
        EXPECT_EQ(block.type().validate(block).empty(), radius < 1.0) << radius << " at " << angle;
      }
    }
  }
}

// A sample held for a cycle T is the mean of u over [t - T, t]: sin(wT/2)/(wT/2), half a cycle late.
TEST(KernelLaws, AHoldsResponseIsTheMeanOverItsCycle) {
  const Block hold = make_block("sample_hold").set("clock_hz", 100.0);
  const Block late = make_block("sample_hold").set("clock_hz", 100.0).set("half_cycle", 1.0);
  for (const double f : {0.0, 7.0, 50.0, 100.0, 130.0}) {
    const Complex s(0.0, 2.0 * M_PI * f);
    const Complex mean = f == 0.0 ? 1.0 : (1.0 - std::exp(-s * 0.01)) / (s * 0.01);
    EXPECT_LT(std::abs(*hold.response({s.imag()}) - mean), 1e-14) << f;
    EXPECT_LT(std::abs(*late.response({s.imag()}) - mean * std::exp(-0.005 * s)), 1e-14) << f;
  }
}

// What the poles are the roots of: P + s D per_hz/(2 pi), P of the section, D = d0 + d1 s/w + d2 (s/w)^2.
TEST(OpampPoles, AreTheRootsOfTheirPolynomial) {
  const std::vector<Block> sections = {
      make_block("gain").set("gain", 2.0), make_block("pole_zero").set("zero_hz", 30.0).set("pole_hz", 200.0),
      make_block("resonator").set("natural_frequency_hz", 200.0).set("damping_ratio", 0.2),
      make_block("resonator").set("natural_frequency_hz", 200.0).set("damping_ratio", 6.0)};
  for (const Block& section : sections) {
    for (const double per_hz : {1e-7, 3e-4, 2e-2}) {
      const double d[3] = {2.0, 3.5, 1.5};
      const OpampPoles poles = opamp_poles(section, d, per_hz);
      const int order = corner_of(section).empty() ? 0 : section.has("damping_ratio") ? 2 : 1;
      EXPECT_EQ(poles.last.has_value(), order != 1);
      EXPECT_EQ(poles.natural_frequency_hz > 0.0, order > 0);
      for (const Complex s : {Complex(0.0, 100.0), Complex(30.0, 2e3), Complex(-500.0, 9e3)}) {
        const Complex x = s / (2.0 * M_PI * 200.0);
        const Complex p = order == 0   ? 1.0
                          : order == 1 ? 1.0 + x
                                       : 1.0 + 2.0 * section.get("damping_ratio") * x + x * x;
        const Complex wanted =
            p + s / (2.0 * M_PI) * per_hz *
                    (d[0] + (order > 0 ? d[1] * x : 0.0) + (order > 1 ? d[2] * x * x : 0.0));
        Complex made = poles.last ? 1.0 + s / poles.last->rad_s().value : 1.0;
        if (order > 0) {
          const Complex y = s / (2.0 * M_PI * poles.natural_frequency_hz);
          made *= 1.0 + 2.0 * poles.damping_ratio * y + y * y;
        }
        EXPECT_LT(std::abs(made / wanted - 1.0), 1e-9) << section.type_name() << " " << per_hz;
      }
      if (order == 2 && poles.damping_ratio > 1.0) {  // of three real ones the last is the fastest
        const double fast = poles.damping_ratio + std::sqrt(poles.damping_ratio * poles.damping_ratio - 1.0);
        EXPECT_GE(poles.last->value * (1.0 + 1e-9), fast * poles.natural_frequency_hz);
      }
    }
  }
}

// (N + s F per_hz/(2 pi))/(P + s D per_hz/(2 pi)) of a biquad N/P; without a third zero the block behind has a pole alone.
TEST(OpampPoles, AWayRoundMovesTheZeros) {
  const Block biquad = make_block("biquad")
                           .set("lowpass_gain", 0.4)
                           .set("bandpass_gain", -0.3)
                           .set("highpass_gain", 1.2)
                           .set("natural_frequency_hz", 200.0)
                           .set("damping_ratio", 0.6);
  for (const double third : {0.9, 0.0}) {
    PartChange opamp{.part = "U1"};
    opamp.noise_gain = {2.0, 3.5, 1.5};
    opamp.feedthrough = {0.7, -0.5, third};
    for (const double per_hz : {1e-7, 3e-5, 4e-4}) {
      const SlowSection made = slow_section(biquad, opamp, per_hz);
      EXPECT_EQ(made.behind.type_name(), third == 0.0 ? "lowpass" : "pole_zero");
      for (const double hz : {3.0, 150.0, 260.0, 4e4}) {
        const Complex x(0.0, hz / 200.0), e(0.0, hz * per_hz);
        const Complex wanted = (0.4 + x * (-0.3 + 1.2 * x) + e * (0.7 + x * (-0.5 + third * x))) /
                               (1.0 + x * (1.2 + x) + e * (2.0 + x * (3.5 + 1.5 * x)));
        const RadPerSecond w = Hertz{hz}.rad_s();
        EXPECT_LT(std::abs(*made.section.response(w) * *made.behind.response(w) / wanted - 1.0), 1e-9)
            << per_hz << " " << hz;
      }
    }
  }
}

TEST(LinearKernels, InSeriesAreTheProductAndDelaysAdd) {
  LinearKernel first = pole_zero_kernel(2.0, 30.0, 100.0), second = pole_zero_kernel(-0.5, INFINITY, 7.0);
  first.delay_s = 1e-3;
  first.approximation_error = 1e-6;
  second.delay_s = 2e-3;
  second.approximation_error = 2e-6;
  const LinearKernel both = in_series(first, second);
  EXPECT_NEAR(both.delay_s, 3e-3, 1e-18);
  EXPECT_NEAR(both.approximation_error, 3e-6, 1e-18);
  const Complex s(0.0, 40.0);
  const Complex wanted =
      2.0 * (1.0 + s / 30.0) / (1.0 + s / 100.0) * -0.5 / (1.0 + s / 7.0) * std::exp(-3e-3 * s);
  EXPECT_LT(std::abs(response(both, s) - wanted), 1e-14);
}

TEST(FractionalBlock, IsItsPowerOnTheAxisAndOffIt) {
  const Block block = make_block("fractional_lead_lag").set("lambda_s", 0.2).set("x", 0.05).set("beta", 0.37);
  EXPECT_NEAR(block.transfer({3.0, 0.0})->real(), std::pow(1.6 / 1.03, 0.37), 1e-14);
  for (const double w : {0.1, 5.0, 300.0}) {
    const Complex wanted = std::pow((1.0 + Complex(0.0, 0.2 * w)) / (1.0 + Complex(0.0, 0.01 * w)), 0.37);
    EXPECT_LT(std::abs(*block.response({w}) - wanted), 1e-13) << w;
    EXPECT_LT(std::abs(*block.transfer({0.0, w}) - wanted), 1e-13) << w;
  }
}

}  // namespace
}  // namespace bodesmith::chain
