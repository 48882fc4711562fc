// Laws that hold for whole families of models, over random motions (one parameter a model).
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "hysteresis/model_type.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

using testing::Random;

/// A model of every type with memory of turning points, on inputs in [0, 1].
Model example(const std::string& type) {
  Random random(77);
  Parameters values;
  std::vector<double> w(30 * 31 / 2);
  for (double& one : w) one = random.uniform() < 0.2 ? 0.0 : random.uniform() / 400.0;
  if (type == "preisach") values.set("u_min", 0.0).set("u_max", 1.0).set("w", w);
  if (type == "krasnoselskii_pokrovskii") values.set("u_min", 0.0).set("u_max", 1.0).set("mu", w);
  if (type == "prandtl_ishlinskii") {
    values.set("r", {0.0, 0.05, 0.15, 0.3})
        .set("w", {0.6, 0.1, 0.2, 0.3})
        .set("s", {0.3, 0.7})
        .set("v", {0.1, -0.2});
  }
  if (type == "exponential_operator") values.set("k", {0.8, 0.3}).set("tau", {30.0, 2.0});
  if (type == "polynomial_hysteresis") {
    values.set("ascending", {-0.3546, 0.6433, -0.2887})
        .set("descending", {0.2398, -0.0838, -0.156})
        .set("minor", "nested");
  }
  if (type == "sine_hysteresis")
    values.set("A_ascending", -0.08).set("A_descending", 0.1).set("minor", "nested");
  return make_model(type, values);
}

class Law : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Operator> op() const { return make_operator(example(GetParam())); }
};

/// Drives through the points in `steps` samples each; returns the output at every point.
std::vector<double> drive(Operator& op, const std::vector<double>& points, int steps) {
  std::vector<double> out;
  double from = points.front();
  out.push_back(op.reset(from));
  for (std::size_t i = 1; i < points.size(); ++i) {
    double y = out.back();
    for (int k = 1; k <= steps; ++k)
      y = op.step(k == steps ? points[i] : from + (points[i] - from) * k / steps, 1e-3);
    from = points[i];
    out.push_back(y);
  }
  return out;
}

std::vector<double> random_points(Random& random, int count) {
  std::vector<double> points{0.0};
  for (int i = 0; i < count; ++i) points.push_back(random.uniform());
  return points;
}

TEST_P(Law, WipingOut) {
  // Whatever happens inside a larger swing is forgotten once the swing is passed.
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const auto plain = op();
    const auto busy = op();
    const double top = 0.7 + 0.3 * random.uniform();
    const double bottom = 0.3 * random.uniform();
    drive(*plain, {0.0, top, bottom}, 3);
    std::vector<double> detour{0.0, top};
    for (int i = 0; i < 7; ++i) detour.push_back(bottom + (top - bottom) * random.uniform());
    detour.push_back(bottom);
    drive(*busy, detour, 3);
    for (int i = 0; i < 10; ++i) {
      const double u = random.uniform();
      ASSERT_NEAR(plain->step(u, 1.0), busy->step(u, 1.0), 1e-12) << trial;
    }
  }
}

TEST_P(Law, ReturnPointMemory) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const auto o = op();
    const double a = 0.9, b = 0.1 + 0.2 * random.uniform(), c = b + (a - b) * (0.2 + 0.7 * random.uniform());
    const std::vector<double> y = drive(*o, {0.0, a, b, c, b}, 5);
    ASSERT_NEAR(y[2], y[4], 1e-12);  // the minor loop b-c-b closes
  }
}

TEST_P(Law, RateIndependence) {
  Random random(3);
  const std::vector<double> points = random_points(random, 50);
  const auto slow = op();
  const auto fast = op();
  const std::vector<double> a = drive(*slow, points, 40);
  const std::vector<double> b = drive(*fast, points, 1);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-12) << i;
  EXPECT_TRUE(slow->rate_independent());
}

TEST_P(Law, OutputRisesWithInputAndInverseIsMonotone) {
  Random random(4);
  const auto o = op();
  const auto inverse = make_inverse(example(GetParam()));
  double u = 0.0;
  double y = o->reset(u);
  double wanted = inverse->reset(0.2), back = wanted;
  double before = 0.2;
  for (int i = 0; i < 3000; ++i) {
    const double next = random.uniform();
    const double after = o->step(next, 1.0);
    ASSERT_GE((after - y) * (next - u), -1e-13);
    u = next;
    y = after;
    const double r = 0.05 + 0.5 * random.uniform();
    wanted = inverse->step(r, 1.0);
    ASSERT_GE((wanted - back) * (r - before), -1e-13);
    back = wanted;
    before = r;
  }
}

TEST_P(Law, NoEnergyIsCreated) {
  // Around any closed loop the input does work on the operator: the loop's area, the integral of u dy, is not
  // negative.
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const auto o = op();
    std::vector<double> cycle = random_points(random, 6);
    std::vector<double> points{0.0, 1.0, 0.0};
    for (int lap = 0; lap < 3; ++lap) points.insert(points.end(), cycle.begin(), cycle.end());
    double u = 0.0, y = o->reset(0.0), area = 0.0, first_y = 0.0;
    const std::size_t start = 3 + 2 * cycle.size() - 1;
    for (std::size_t i = 1; i < points.size(); ++i) {
      for (int k = 1; k <= 200; ++k) {
        const double next = points[i - 1] + (points[i] - points[i - 1]) * k / 200.0;
        const double after = o->step(next, 1.0);
        if (i > start) area += 0.5 * (u + next) * (after - y);
        u = next;
        y = after;
      }
      if (i == start) first_y = y;
    }
    ASSERT_NEAR(y, first_y, 1e-9);  // the third lap ends where it began
    ASSERT_GE(area, -1e-6) << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Law,
                         ::testing::Values("preisach", "krasnoselskii_pokrovskii", "prandtl_ishlinskii",
                                           "exponential_operator", "polynomial_hysteresis",
                                           "sine_hysteresis"));

class Congruency : public Law {};

TEST_P(Congruency, MinorLoopsOfEqualSpanAreCongruent) {
  // Between the same two inputs every minor loop has the same shape, wherever it lies.
  Random random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const double low = 0.3 + 0.2 * random.uniform();
    const double high = low + 0.05 + 0.2 * random.uniform();
    const auto one = op();
    const auto other = op();
    const std::vector<double> a =
        drive(*one, {0.0, 0.95, 0.1 * random.uniform(), high, low, 0.5 * (low + high), low, high}, 2);
    const std::vector<double> b = drive(*other, {0.0, 1.0, low, 0.5 * (low + high), low, high}, 2);
    ASSERT_NEAR(a[5] - a[4], b[3] - b[2], 1e-12);
    ASSERT_NEAR(a[7] - a[6], b[5] - b[4], 1e-12);
  }
}

// The plain forms only: dead zones (prandtl_ishlinskii above) and the nested polynomials bend loops by where
// they lie.
INSTANTIATE_TEST_SUITE_P(Models, Congruency,
                         ::testing::Values("preisach", "krasnoselskii_pokrovskii", "exponential_operator"));

TEST(Laws, MemoryIsBoundedHoweverLongTheRecord) {
  // Ever smaller swings: more nested loops than the stack keeps. It goes on, stays continuous and right at
  // the turn-back.
  const auto o = make_operator(example("preisach"));
  o->reset(0.0);
  o->step(0.9, 1.0);
  double last = 0.0;
  for (int i = 1; i < 20000; ++i) {
    const double swing = 0.4 * (1.0 - i / 20001.0);
    last = o->step(0.45 + (i % 2 ? -swing : swing), 1.0);
    ASSERT_TRUE(std::isfinite(last));
  }
  const auto fresh = make_operator(example("preisach"));
  fresh->reset(0.0);
  fresh->step(0.9, 1.0);
  EXPECT_NEAR(o->step(0.02, 1.0), fresh->step(0.02, 1.0), 1e-12);
}

}  // namespace
}  // namespace bodesmith::hysteresis
