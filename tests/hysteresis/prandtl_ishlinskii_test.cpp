#include "hysteresis/prandtl_ishlinskii.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "hysteresis/model_type.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

using testing::Random;

PrandtlIshlinskii asymmetric_model() {
  PrandtlIshlinskii model;
  model.r = {0.0, 0.3, 0.7, 1.1, 1.9};
  model.w = {0.8, 0.1, 0.25, 0.0, 0.4};
  model.s = {0.5, -0.4, 1.7, -1.0};
  model.v = {0.2, -0.3, -0.15, 0.4};
  model.offset = -0.7;
  return model;
}

TEST(PrandtlIshlinskii, OnePlayIsBacklash) {
  PrandtlIshlinskii model;
  model.r = {0.0, 0.5};
  model.w = {1e-12, 1.0};
  PrandtlIshlinskiiOperator op(model);
  EXPECT_NEAR(op.reset(0.0), 0.0, 1e-9);
  EXPECT_NEAR(op.step(0.4, 1.0), 0.0, 1e-9);
  EXPECT_NEAR(op.step(2.0, 1.0), 1.5, 1e-9);
  EXPECT_NEAR(op.step(1.2, 1.0), 1.5, 1e-9);  // within the play
  EXPECT_NEAR(op.step(0.0, 1.0), 0.5, 1e-9);
}

// x - .6 max(0, s) - .2 min(0, s) of the stop s of radius .5, by hand.
TEST(PrandtlIshlinskii, AStopMayWeighMoreAboveZero) {
  PrandtlIshlinskii model;
  model.r = {0.0, 0.5};
  model.w = {0.8, 0.2};
  model.e = {0.0, -0.4};
  PrandtlIshlinskiiOperator op(model);
  EXPECT_NEAR(op.reset(0.0), 0.0, 1e-15);
  EXPECT_NEAR(op.step(0.4, 1.0), 0.4 - 0.6 * 0.4, 1e-15);
  EXPECT_NEAR(op.step(2.0, 1.0), 2.0 - 0.6 * 0.5, 1e-15);
  EXPECT_NEAR(op.peek(1.2, 1.0), 1.2 + 0.2 * 0.3, 1e-15);
  EXPECT_NEAR(op.step(1.2, 1.0), 1.2 + 0.2 * 0.3, 1e-15);
  EXPECT_NEAR(op.step(-1.0, 1.0), -1.0 + 0.2 * 0.5, 1e-15);
  EXPECT_THROW(PrandtlIshlinskiiInverse{model}, DesignError);
}

TEST(PrandtlIshlinskii, AnalyticInverseIsExactOverRandomMotion) {
  Random random(7);
  for (const auto start : {PrandtlIshlinskii::Start::rest_zero, PrandtlIshlinskii::Start::from_above,
                           PrandtlIshlinskii::Start::from_below}) {
    PrandtlIshlinskii model = asymmetric_model();
    model.start = start;
    PrandtlIshlinskiiOperator forward(model);
    PrandtlIshlinskiiInverse inverse(model);
    double wanted = 0.3;
    EXPECT_NEAR(forward.reset(inverse.reset(wanted)), wanted, 1e-12);
    for (int i = 0; i < 5000; ++i) {
      wanted += 0.4 * (random.uniform() - 0.5) - 0.01 * wanted;
      const double u = inverse.step(wanted, 1.0);
      ASSERT_NEAR(forward.step(u, 1.0), wanted, 1e-11) << i;
    }
  }
}

// Every play stands at its upper edge after a fall from far above, at its lower one after a rise: moving on the same way it moves at once.
TEST(PrandtlIshlinskii, StartsFromAboveOrBelow) {
  PrandtlIshlinskii model;
  model.r = {0.0, 0.3, 0.7};
  model.w = {0.8, 0.1, 0.25};
  for (const double way : {1.0, -1.0}) {
    model.start = way > 0.0 ? PrandtlIshlinskii::Start::from_above : PrandtlIshlinskii::Start::from_below;
    PrandtlIshlinskiiOperator op(model);
    EXPECT_NEAR(op.reset(0.2), 1.15 * 0.2 + way * (0.1 * 0.3 + 0.25 * 0.7), 1e-15);
    EXPECT_NEAR(op.step(0.2 - 0.05 * way, 1.0), 1.15 * (0.2 - 0.05 * way) + way * (0.1 * 0.3 + 0.25 * 0.7),
                1e-15);
    EXPECT_NEAR(op.step(0.2, 1.0), 0.8 * 0.2 + 0.35 * (0.2 - 0.05 * way) + way * (0.1 * 0.3 + 0.25 * 0.7),
                1e-15);
  }
}

TEST(PrandtlIshlinskii, EnvelopeInverseTellsWhenOutOfReach) {
  PrandtlIshlinskii model = asymmetric_model();
  model.s.clear();
  model.v.clear();
  model.gamma = {2.0, 0.5, 0.1, 0.0};
  PrandtlIshlinskiiOperator forward(model);
  PrandtlIshlinskiiInverse inverse(model);
  EXPECT_NEAR(forward.reset(inverse.reset(-0.2)), -0.2, 1e-9);
  for (const double wanted : {0.1, 0.6, -0.9, 0.2}) {
    EXPECT_NEAR(forward.step(inverse.step(wanted, 1.0), 1.0), wanted, 1e-9);
    EXPECT_NEAR(inverse.achieved(), wanted, 1e-9);
  }
  inverse.step(50.0, 1.0);
  EXPECT_LT(inverse.achieved(), 10.0);
}

TEST(PrandtlIshlinskii, IdentificationFindsItsOwnWeights) {
  PrandtlIshlinskii model;
  for (int i = 0; i < 10; ++i) {
    model.r.push_back(0.5 * 4.0 * i / 10);
    model.w.push_back(i == 3 ? 0.0 : 0.3 + 0.05 * i);
  }
  model.u_0 = -2.0;
  model.offset = 5.0;
  PrandtlIshlinskiiOperator op(model);
  const std::vector<double> u = testing::modulated_triangle(4000, -2.0, 2.0, 150);
  std::vector<double> y{op.reset(u[0])};
  for (std::size_t i = 1; i < u.size(); ++i) y.push_back(op.step(u[i], 1e-3));
  const TimeRecord record = testing::record(u, y);
  const Identified found = model_type_registry().get("prandtl_ishlinskii").identify({&record, 1}, {});
  EXPECT_LT(testing::errors_of(found, {&record, 1}).rms, 1e-8);
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_NEAR(found.model.parameters.list("w")[i], model.w[i], 1e-6) << i;
}

// A play that would weigh less than nothing is left out: its weight is 0 and known; what is free has a deviation, the offset too.
TEST(PrandtlIshlinskii, WhatIsAtItsBoundHasNoDeviation) {
  Random random(5);
  for (const double sign : {1.0, -1.0}) {
    PrandtlIshlinskii model;
    model.r = {0.0, 0.5, 1.0, 1.5};
    model.w = {1.0, 0.3, -0.4, 0.5};
    PrandtlIshlinskiiOperator op(model);
    const std::vector<double> u = testing::modulated_triangle(600, 0.0, 4.0, 100);
    std::vector<double> y;
    for (std::size_t i = 0; i < u.size(); ++i)
      y.push_back(sign * 20.0 + (i == 0 ? op.reset(u[i]) : op.step(u[i], 1e-3)) + 0.01 * random.uniform());
    const TimeRecord record = testing::record(u, y);
    IdentifyOptions options;
    options.size = 8;
    const Identified found = model_type_registry().get("prandtl_ishlinskii").identify({&record, 1}, options);
    int bound = 0;
    for (const ParameterUncertainty& one : found.uncertainty) {
      if (one.name != "offset" && one.value == 0.0) {
        EXPECT_EQ(one.standard_deviation, 0.0) << one.name;
        ++bound;
      } else if (one.name != "w[0]") {
        EXPECT_GT(one.standard_deviation, 0.0) << one.name;
      }
    }
    EXPECT_GT(bound, 0);
  }
}

TEST(PrandtlIshlinskii, AsymmetricIdentificationBeatsSymmetricOnAsymmetricData) {
  PrandtlIshlinskiiOperator op([] {
    PrandtlIshlinskii model;
    model.r = {0.0, 0.4, 0.9};
    model.w = {1.0, 0.3, 0.4};
    model.s = {1.1, 2.0};
    model.v = {-0.1, -0.08};
    return model;
  }());
  const std::vector<double> u = testing::modulated_triangle(4000, 0.0, 4.0, 100);
  std::vector<double> y{op.reset(u[0])};
  for (std::size_t i = 1; i < u.size(); ++i) y.push_back(op.step(u[i], 1e-3));
  const TimeRecord record = testing::record(u, y);
  IdentifyOptions options;
  const Identified plain = model_type_registry().get("prandtl_ishlinskii").identify({&record, 1}, options);
  options.asymmetric = true;
  const Identified shaped = model_type_registry().get("prandtl_ishlinskii").identify({&record, 1}, options);
  EXPECT_LT(testing::errors_of(shaped, {&record, 1}).rms, 0.7 * testing::errors_of(plain, {&record, 1}).rms);
}

TEST(PrandtlIshlinskii, RefusesWhatHasNoMeaning) {
  Parameters values;
  values.set("r", {0.0, 1.0}).set("w", {1.0, -1.0});
  EXPECT_THROW(make_model("prandtl_ishlinskii", values), DesignError);
  values.set("w", std::vector<double>{1.0});
  EXPECT_THROW(make_model("prandtl_ishlinskii", values), DesignError);
  values.set("r", std::vector<double>{0.5});
  EXPECT_THROW(make_model("prandtl_ishlinskii", values), DesignError);
  // In its upper half, before it gives way, the stop takes more than all: the output falls.
  values.set("r", {0.0, 1.0}).set("w", {0.8, 0.2}).set("e", {0.0, -0.7});
  EXPECT_NO_THROW(make_model("prandtl_ishlinskii", values));
  values.set("e", {0.0, -0.9});
  EXPECT_THROW(make_model("prandtl_ishlinskii", values), DesignError);
  values.set("e", std::vector<double>{0.1});
  EXPECT_THROW(make_model("prandtl_ishlinskii", values), DesignError);
}

}  // namespace
}  // namespace bodesmith::hysteresis
