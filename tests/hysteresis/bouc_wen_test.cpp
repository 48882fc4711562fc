#include "hysteresis/bouc_wen.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "hysteresis/model_type.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

/// The state's equation integrated in very small steps: independent of the closed form.
double brute_force(const BoucWen& model, double z, double du) {
  const int steps = 40000;
  const double h = du / steps;
  const double sign = du > 0.0 ? 1.0 : -1.0;
  const auto slope = [&](double v) {
    const double p = std::pow(std::abs(v), model.n);
    return model.A - (model.beta * sign + model.delta) * (v >= 0.0 ? p : -p) - model.gamma * p;
  };
  for (int i = 0; i < steps; ++i) z += h * slope(z + 0.5 * h * slope(z));
  return z;
}

TEST(BoucWen, ClosedFormAndStepsAgreeWithBruteForce) {
  for (const double n : {1.0, 1.7, 3.0}) {
    for (const double gamma : {-0.5, 0.0, 0.8}) {
      for (const double amplitude : {0.6, -0.6}) {
        const BoucWen model{2.0, amplitude, 1.3, gamma, n, 0.0, 0.0, amplitude * gamma};
        double z = 0.0;
        for (const double move : {0.7, -0.3, -1.5, 2.2, 0.1, -0.05}) {
          const double expected = brute_force(model, z, move);
          z = model.advance(z, move);
          ASSERT_NEAR(z, expected, 2e-6) << n << " " << gamma << " " << amplitude << " " << move;
        }
      }
    }
  }
}

TEST(BoucWen, ASteepLoopSettlesWhereItsEquationSays) {
  // In steps in proportion to beta these would never end.
  for (const double n : {1.5, 3.0}) {
    for (const double gamma : {-0.9, 0.0, 0.9}) {
      const BoucWen model{1.0, 0.7, 1e12, gamma * 1e12, n, 0.0, 0.0};
      double z = 2.0;
      for (const double direction : {1.0, -1.0}) {
        z = model.advance(z, direction);
        const double settled = direction * std::pow(model.A / (model.beta + model.gamma), 1.0 / n);
        EXPECT_NEAR(z / settled, 1.0, 1e-9) << n << " " << gamma;
      }
    }
  }
}

TEST(BoucWen, OneMoveOrManyGiveTheSame) {
  for (const double n : {1.0, 1.2, 2.0, 11.0}) {
    for (const double gamma : {-1.3, -0.4, 1.1}) {
      const BoucWen model{2.0, 0.6, 1.3, gamma, n, 0.0, 0.0};
      BoucWenOperator once(model);
      BoucWenOperator often(model);
      double from = 0.0;
      for (const double target : {1.0, -0.4, 0.8, 0.1, 0.1003, -5.0}) {
        const double y = once.step(target, 1.0);
        double last = 0.0;
        for (int k = 1; k <= 57; ++k) last = often.step(from + (target - from) * k / 57.0, 1e-3);
        from = target;
        ASSERT_NEAR(y, last, 2e-10) << n << " " << gamma << " " << target;
      }
    }
  }
}

TEST(BoucWen, OfSharpnessTwoIsAHyperbolicTangentFromZero) {
  const BoucWen model{1.0, 0.6, 1.3, 0.4, 2.0, 0.0, 0.0};
  const double rest = std::sqrt(model.A / (model.beta + model.gamma));
  for (const double move : {1e-6, 0.01, 0.3, 1.0, 4.0, 50.0})
    EXPECT_NEAR(model.advance(0.0, move), rest * std::tanh(move * model.A / rest), 1e-11) << move;
}

// Coleman and Hodgdon's loop x + w, dw = rate |dx| (slope x - w) with another rate each way, in closed form from turn to turn.
TEST(BoucWen, LagsBehindALineAtARateEachWay) {
  const double slope = 0.2, up = 1.7, down = 0.9;
  const BoucWen model{1.0 + slope, slope, 0.5 * (up + down), 0.0, 1.0, 0.0, 0.0, 0.5 * (up - down)};
  BoucWenOperator op(model);
  double x = 0.0, w = 0.0;
  for (const double target : {0.8, -0.5, 1.4, 1.1, 0.2}) {
    // From x on w - slope x decays towards -slope d/rate, d the direction.
    const double rate = target > x ? up : down;
    const double rest = (target > x ? -slope : slope) / rate;
    w = slope * target + rest + (w - slope * x - rest) * std::exp(-rate * std::abs(target - x));
    x = target;
    EXPECT_NEAR(op.step(x, 1.0), x + w, 1e-14) << x;
  }
}

TEST(BoucWen, InverseTracks) {
  Parameters values;
  values.set("k", 2.0).set("A", 0.5).set("beta", 1.3).set("gamma", 0.9).set("delta", -0.2);
  const Model model = make_model("bouc_wen", values);
  const auto forward = make_operator(model);
  const auto inverse = make_inverse(model);
  EXPECT_NEAR(forward->reset(inverse->reset(0.2)), 0.2, 1e-9);
  testing::Random random(3);
  double y = 0.2;
  for (int i = 0; i < 500; ++i) {
    y += 0.5 * (random.uniform() - 0.5);
    ASSERT_NEAR(forward->step(inverse->step(y, 1.0), 1.0), y, 1e-12);
  }
  values.set("k", 0.3);
  EXPECT_THROW(make_inverse(make_model("bouc_wen", values)), DesignError);
}

TEST(BoucWen, IdentificationFindsItsOwnParameters) {
  const BoucWen model{3.0, 1.1, 1.4, 0.5, 1.0, 0.0, 2.0};
  BoucWenOperator op(model);
  const std::vector<double> u = testing::modulated_triangle(1500, 0.0, 2.0, 60);
  std::vector<double> y{op.reset(u[0])};
  for (std::size_t i = 1; i < u.size(); ++i) y.push_back(op.step(u[i], 1e-3));
  const TimeRecord record = testing::record(u, y);
  const Identified found = model_type_registry().get("bouc_wen").identify({&record, 1}, {});
  EXPECT_LT(testing::errors_of(found, {&record, 1}).rms_percent, 0.02);
}

}  // namespace
}  // namespace bodesmith::hysteresis
