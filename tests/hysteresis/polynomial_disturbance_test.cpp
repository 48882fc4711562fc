#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "hysteresis/polynomial_disturbance.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

// The first seed's full-stroke polynomials.
constexpr std::array<double, 3> kAscending{0.3546, -0.6433, 0.2887};
constexpr std::array<double, 3> kDescending{-0.2398, 0.0838, 0.156};

double cubic(const std::array<double, 3>& a, double x) {
  return x * (a[0] + x * (a[1] + x * a[2]));
}

Model seed_model(const char* minor) {
  Parameters values;
  values.set("ascending", std::vector<double>(kAscending.begin(), kAscending.end()));
  values.set("descending", std::vector<double>(kDescending.begin(), kDescending.end()));
  values.set("minor", minor);
  return make_model("polynomial_hysteresis", values);
}

TEST(Polynomial, ContractBlockIsTheSignOfTheSlopeAlone) {
  const auto op = make_operator(seed_model("slope_sign"));
  op->reset(0.0);
  for (const double x : {0.1, 0.5, 0.9}) EXPECT_DOUBLE_EQ(op->step(x, 1.0), x + cubic(kAscending, x));
  for (const double x : {0.8, 0.4, 0.2}) EXPECT_DOUBLE_EQ(op->step(x, 1.0), x + cubic(kDescending, x));
  EXPECT_DOUBLE_EQ(op->step(0.2, 1.0), 0.2 + cubic(kDescending, 0.2));  // at rest the branch stays
}

/// The branch turns a fixed time after the input does, each turn by itself, and peek() is what step() will say.
TEST(Polynomial, ALateSwitchFollowsEachTurnItsDelayLater) {
  for (const double delay : {1e-5, 3.5e-3, 40.5e-3}) {
    PolynomialDisturbance model;
    model.ascending.polynomial = kAscending;
    model.descending.polynomial = kDescending;
    model.switch_delay_s = delay;
    PolynomialOperator late(model);
    late.reset(0.5);
    const double dt = 1e-3;
    std::vector<bool> rising{true};
    double u = 0.5;
    std::uint32_t state = 7;
    for (int k = 1; k < 400; ++k) {
      // Turns at random, then at every sample (more than are kept), then none.
      state = state * 1664525u + 1013904223u;
      const bool up = k < 200   ? ((state >> 28) == 0 ? !rising.back() : rising.back())
                      : k < 300 ? !rising.back()
                                : false;
      u += up ? 1e-3 : -1e-3;
      rising.push_back(up);
      bool branch = true;
      for (std::size_t i = 1; i < rising.size(); ++i) {
        if (rising[i] != rising[i - 1] && static_cast<double>(rising.size() - i) * dt >= delay)
          branch = rising[i];
      }
      const double ahead = late.peek(u, dt);
      const double y = late.step(u, dt);
      EXPECT_EQ(y, ahead) << k;
      const bool told = k < 200 || k > 345;
      EXPECT_EQ(y, told ? model.plain(branch, u) : y) << k << " " << delay;
    }
  }
}

TEST(Polynomial, BranchesArePolynomialsOfTheInputAtAnyStroke) {
  Parameters values;
  values.set("ascending", std::vector<double>(kAscending.begin(), kAscending.end()));
  values.set("descending", std::vector<double>(kDescending.begin(), kDescending.end()));
  values.set("minor", "slope_sign");
  values.set("amplitude", 0.7);
  values.set("switch_delay_s", 2e-3);
  values.set("constant_ascending", 0.01);
  values.set("constant_descending", -0.02);
  const Model model = make_model("polynomial_hysteresis", values);
  const auto curves = model.type->branch_curves(model.parameters);
  ASSERT_TRUE(curves);
  EXPECT_EQ(curves->switch_delay_s, 2e-3);
  for (double u = -0.3; u < 1.2; u += 0.1) {
    for (const bool rising : {true, false}) {
      const auto& c = rising ? curves->rising : curves->falling;
      ASSERT_EQ(c.size(), 4u);
      const double wanted =
          u + (rising ? 0.01 : -0.02) + 0.7 * cubic(rising ? kAscending : kDescending, u / 0.7);
      EXPECT_NEAR(c[0] + u * (c[1] + u * (c[2] + u * c[3])), wanted, 1e-14) << u;
      EXPECT_NEAR(curves->curve(rising, u), wanted, 1e-14) << u;
    }
  }
}

// Without gains of its own a stroke of another size is the full one in another unit, its inverse too: beyond what a branch reaches it
// ends where the branch no longer rises.
TEST(Polynomial, AStrokeOfAnotherSizeIsTheFullOneInAnotherUnit) {
  PolynomialDisturbance full;
  full.nested = false;
  full.ascending.polynomial = {0.2, 0.3, -0.5};
  full.descending.polynomial = kDescending;
  for (const double size : {0.4, 1.0, 2.5}) {
    PolynomialDisturbance other = full;
    other.amplitude = size;
    for (const bool rising : {true, false}) {
      for (double x = -0.6; x <= 1.7; x += 0.1) {
        EXPECT_NEAR(other.plain(rising, size * x), size * full.plain(rising, x), 1e-12);
        EXPECT_NEAR(other.input_on(rising, size * x), size * full.input_on(rising, x), 1e-9 * size) << x;
      }
      for (double x = 0.05; x < 1.0; x += 0.1)
        EXPECT_NEAR(full.input_on(rising, full.plain(rising, x)), x, 1e-9);
    }
  }
  // 1.9 - 1.8 s = 0.
  PolynomialDisturbance square;
  square.ascending.polynomial = {0.9, -0.9, 0.0};
  EXPECT_NEAR(square.input_on(true, 2.0), 1.9 / 1.8, 1e-6);
  EXPECT_NEAR(square.input_on(true, square.plain(true, -3.0)), -3.0, 1e-9);
  // 1.2 + .6 s - 1.5 s^2 = 0.
  const double turn = (0.6 + std::sqrt(0.36 + 4.0 * 1.5 * 1.2)) / 3.0;
  EXPECT_NEAR(full.input_on(true, 2.0 * full.plain(true, turn)), turn, 1e-6);
}

TEST(Polynomial, NestedRuleIsThePapersOnFullStrokesAndClosesMinorLoops) {
  const auto op = make_operator(seed_model("nested"));
  op->reset(0.0);
  EXPECT_NEAR(op->step(0.5, 1.0), 0.5 + cubic(kAscending, 0.5), 1e-15);
  EXPECT_NEAR(op->step(1.0, 1.0), 1.0, 1e-12);
  EXPECT_NEAR(op->step(0.3, 1.0), 0.3 + cubic(kDescending, 0.3), 1e-12);
  const double turn = op->step(0.3, 1.0);
  const double up = op->step(0.6, 1.0);
  EXPECT_GT(up, turn);
  EXPECT_NEAR(op->step(0.3, 1.0), turn, 1e-12);                           // the minor loop closes
  EXPECT_NEAR(op->step(0.1, 1.0), 0.1 + cubic(kDescending, 0.1), 1e-12);  // and the major branch goes on
}

TEST(Polynomial, NestedRuleIsContinuousOnTheComplexReference) {
  const auto op = make_operator(seed_model("nested"));
  double before = op->reset(0.415);
  for (int i = 1; i <= 20000; ++i) {
    const double t = i * 1e-3;
    const double x =
        0.415 + 0.23 * (std::sin(2 * std::numbers::pi * t) + 0.3 * std::sin(std::numbers::pi * t) +
                        0.5 * std::sin(0.2 * std::numbers::pi * t));
    const double y = op->step(x, 1e-3);
    ASSERT_LT(std::abs(y - before), 0.006) << t;
    before = y;
  }
}

TEST(Polynomial, InverseOfBothRulesAndOnAStair) {
  const auto forward = make_operator(seed_model("nested"));
  const auto inverse = make_inverse(seed_model("nested"));
  testing::Random random(11);
  EXPECT_NEAR(forward->reset(inverse->reset(0.2)), 0.2, 1e-12);
  for (int i = 0; i < 3000; ++i) {
    const double wanted = random.uniform();
    ASSERT_NEAR(forward->step(inverse->step(wanted, 1.0), 1.0), wanted, 1e-12);
  }
  const auto plain = make_inverse(seed_model("slope_sign"));
  plain->reset(0.0);
  for (const double wanted : {0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, 0.0}) {
    plain->step(wanted, 1.0);
    EXPECT_NEAR(plain->achieved(), wanted, 1e-12);
  }
}

// The inverse is judged by the forward rule written out here.
TEST(Polynomial, InverseOfTheSlopeRuleFollowsAStagesOwnSigns) {
  PolynomialDisturbance stage;
  stage.ascending.polynomial = {-0.3546, 0.6433, -0.2887};
  stage.descending.polynomial = {0.2398, -0.0838, -0.156};
  PolynomialInverse inverse(stage);
  double u = inverse.reset(0.3);
  for (int i = 1; i <= 4000; ++i) {
    // Turns at several heights within the stroke, and samples that stand still.
    const double t = 1e-3 * std::floor(i / 2.0);
    const double y = 0.5 - 0.2 * std::cos(8.0 * t) + 0.25 * std::sin(21.0 * t);
    const double next = inverse.step(y, 1e-3);
    const auto& a = (next > u ? stage.ascending : stage.descending).polynomial;
    if (next != u) {
      ASSERT_NEAR(next + next * (a[0] + next * (a[1] + next * a[2])), y, 1e-8) << i;
    }
    ASSERT_NEAR(inverse.achieved(), y, 1e-8) << i;
    ASSERT_GT(next, -0.1);
    ASSERT_LT(next, 1.1);
    u = next;
  }
  // With the paper's signs a turn inside the stroke asks for what lies between the branches: the nearest is half of
  // their distance away at most.
  PolynomialDisturbance paper;
  paper.ascending.polynomial = {0.3546, -0.6433, 0.2887};
  paper.descending.polynomial = {-0.2398, 0.0838, 0.156};
  PolynomialInverse clockwise(paper);
  clockwise.reset(0.2);
  for (int i = 1; i <= 2000; ++i) {
    const double y = 0.5 - 0.3 * std::cos(6.28e-3 * i);
    clockwise.step(y, 1e-3);
    ASSERT_LT(std::abs(clockwise.achieved() - y), 0.08) << i;
  }
}

TEST(Polynomial, LeastSquaresIsEquation5) {
  std::vector<double> x, d;
  testing::Random random(5);
  for (int i = 0; i < 400; ++i) {
    x.push_back(i / 399.0);
    d.push_back(cubic(kAscending, x.back()) + 0.003 * random.normal());
  }
  const PolynomialFit fit = fit_polynomial(x, d);
  // Eq. 5 written out, in long double.
  long double a11 = 0, a12 = 0, a22 = 0, b1 = 0, b2 = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const long double p = -x[i] + x[i] * x[i] * x[i];
    const long double q = -x[i] * x[i] + x[i] * x[i] * x[i];
    a11 += p * p;
    a12 += p * q;
    a22 += q * q;
    b1 -= p * d[i];
    b2 -= q * d[i];
  }
  const long double determinant = a11 * a22 - a12 * a12;
  EXPECT_NEAR(fit.a[0], static_cast<double>((b1 * a22 - b2 * a12) / determinant), 1e-10);
  EXPECT_NEAR(fit.a[1], static_cast<double>((b2 * a11 - b1 * a12) / determinant), 1e-10);
  EXPECT_DOUBLE_EQ(fit.a[2], -fit.a[0] - fit.a[1]);
  EXPECT_NEAR(fit.a[0], 0.3546, 4 * fit.deviation[0]);
}

TEST(Polynomial, BothReadingsOfEquation13) {
  std::array<double, 3> other = kDescending;
  for (double& a : other) a *= 1.17;
  EXPECT_NEAR(disturbance_gain(kDescending, other), 1.17, 1e-12);
  EXPECT_NEAR(disturbance_gain(kDescending, other, GainReading::as_printed), 1.0 / 1.17, 1e-12);
  // Not reciprocal as soon as the shapes differ (Cauchy-Schwarz), and equal to the sums over many samples.
  other[1] += 0.1;
  other[2] -= 0.1;
  const double right = disturbance_gain(kDescending, other);
  const double printed = disturbance_gain(kDescending, other, GainReading::as_printed);
  EXPECT_LT(right * printed, 1.0 - 1e-4);
  double cross = 0, own = 0;
  for (int k = 0; k < 100000; ++k) {
    const double x = (k + 0.5) / 100000;
    cross += cubic(kDescending, x) * cubic(other, x);
    own += cubic(kDescending, x) * cubic(kDescending, x);
  }
  EXPECT_NEAR(right, cross / own, 1e-8);
}

TEST(Polynomial, SineAmplitudeIsEquation10) {
  std::vector<double> x, d;
  for (int i = 0; i <= 300; ++i) {
    x.push_back(i / 300.0);
    d.push_back(0.08 * std::sin(std::numbers::pi * x.back()));
  }
  EXPECT_NEAR(fit_sine(x, d), 0.08, 1e-14);
}

TEST(Polynomial, AmplitudeAndRateGains) {
  Parameters values = seed_model("slope_sign").parameters;
  values.set("alpha", {0.5, 1.0}).set("alpha_1", {0.4, 1.0}).set("alpha_2", {0.3, 1.0}).set("amplitude", 0.5);
  values.set("rate_frequency_hz", {1.0, 100.0}).set("rate_ascending", {1.0, 1.0});
  values.set("rate_descending", {1.0, 1.2}).set("operating_hz", 10.0);
  const auto op = make_operator(make_model("polynomial_hysteresis", values));
  op->reset(0.0);
  EXPECT_NEAR(op->step(0.25, 1.0), 0.25 + 0.4 * cubic(kAscending, 0.5), 1e-15);
  EXPECT_NEAR(op->step(0.2, 1.0), 0.2 + 1.1 * 0.3 * cubic(kDescending, 0.4), 1e-15);
}

TEST(Polynomial, IdentificationRecoversTheSeedsNumbers) {
  const auto op = make_operator(seed_model("nested"));
  std::vector<double> u = testing::modulated_triangle(6000, 0.0, 1.0, 200), y;
  testing::Random random(2);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double value = i == 0 ? op->reset(u[0]) : op->step(u[i], 1e-3);
    y.push_back(6.92 * value - 3.0 + 0.002 * random.normal());
    u[i] = 95.0 * u[i] + 5.0;
  }
  const TimeRecord record = testing::record(u, y);
  const Identified found = model_type_registry().get("polynomial_hysteresis").identify({&record, 1}, {});
  EXPECT_NEAR(found.model.parameters.list("ascending")[0], 0.3546, 0.01);
  EXPECT_NEAR(found.output.gain, 6.92, 0.02);
  EXPECT_LT(testing::errors_of(found, {&record, 1}).rms, 0.0025);
  // The deviation is about right: within a factor of 4 of the miss for all.
  for (const ParameterUncertainty& one : found.uncertainty)
    EXPECT_LT(one.standard_deviation, 0.05) << one.name;
  IdentifyOptions paper;
  paper.method = "paper";
  const Identified printed = model_type_registry().get("polynomial_hysteresis").identify({&record, 1}, paper);
  EXPECT_GT(testing::errors_of(printed, {&record, 1}).rms, 2.0 * testing::errors_of(found, {&record, 1}).rms);
  const Identified sine = model_type_registry().get("sine_hysteresis").identify({&record, 1}, {});
  EXPECT_GT(testing::errors_of(sine, {&record, 1}).rms, testing::errors_of(found, {&record, 1}).rms);
  EXPECT_LT(testing::errors_of(sine, {&record, 1}).rms_percent, 2.0);
}

TEST(Polynomial, RefusesAFallingBranchAndBadTables) {
  Parameters values = seed_model("slope_sign").parameters;
  values.set("ascending", {3.0, -8.0, 5.0});
  EXPECT_THROW(make_inverse(make_model("polynomial_hysteresis", values)), DesignError);
  values.set("ascending", {3.0, -8.0});
  EXPECT_THROW(make_model("polynomial_hysteresis", values), DesignError);
}

}  // namespace
}  // namespace bodesmith::hysteresis
