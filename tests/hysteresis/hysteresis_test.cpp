// step(), peek() and the inverses' step() allocate nothing: every operator new of this program is counted.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "../../examples/hysteresis_tables/virtual_stage.hpp"
#include "count_allocations.hpp"
#include "hysteresis/model_type.hpp"

namespace bodesmith::hysteresis {
namespace {

TEST(NoAllocation, StepsOfOperatorsAndInverses) {
  std::vector<Model> models;
  const auto add = [&](const char* type, Parameters values) { models.push_back(make_model(type, values)); };
  const std::vector<double> w(20 * 21 / 2, 0.01);
  add("preisach", Parameters().set("u_min", 0.0).set("u_max", 1.0).set("w", w));
  add("krasnoselskii_pokrovskii", Parameters().set("u_min", 0.0).set("u_max", 1.0).set("mu", w));
  add("krasnoselskii_pokrovskii",
      Parameters().set("u_min", 0.0).set("u_max", 1.0).set("mu", w).set("a2", 1e-6));
  add("prandtl_ishlinskii",
      Parameters().set("r", {0.0, 0.1}).set("w", {1.0, 0.3}).set("s", {0.4, -0.2}).set("v", {0.1, 0.1}));
  add("exponential_operator", Parameters().set("k", {0.8, 0.3}).set("tau", {30.0, 2.0}));
  add("bouc_wen", Parameters().set("k", 2.0).set("A", 0.5).set("beta", 1.3).set("gamma", 0.9).set("n", 1.5));
  add("polynomial_hysteresis", Parameters()
                                   .set("ascending", {0.35, -0.64, 0.29})
                                   .set("descending", {-0.24, 0.08, 0.16})
                                   .set("minor", "nested"));
  add("ellipse", Parameters()
                     .set("u_A", std::vector<double>{0.5})
                     .set("frequency_hz", std::vector<double>{1.0})
                     .set("gain", std::vector<double>{1.0})
                     .set("phase_rad", std::vector<double>{-0.1})
                     .set("y_0", std::vector<double>{0.0})
                     .set("amplitude", 0.5)
                     .set("operating_hz", 1.0));
  add("fractional_dynamic", Parameters()
                                .set("K_M", 1e6)
                                .set("xi", 0.1)
                                .set("omega_n", 1e3)
                                .set("tau", 1e-3)
                                .set("eta", 0.5)
                                .set("lambda", 0.7)
                                .set("K_p", 1.0)
                                .set("Theta", 0.1)
                                .set("chi", 0.2));
  for (const Model& model : models) {
    const auto op = make_operator(model);
    const auto inverse = make_inverse(model);
    op->reset(0.0);
    inverse->reset(0.1);
    op->step(0.01, 1e-3);
    inverse->step(0.11, 1e-3);
    const long before = allocations;
    for (int i = 0; i < 500; ++i) {
      op->step(0.5 + 0.4 * std::sin(0.3 * i), 1e-3);
      inverse->step(0.3 + 0.15 * std::sin(0.2 * i), 1e-3);
      if (model.type->name() != "ellipse" && model.type->name() != "fractional_dynamic") op->peek(0.4, 1e-3);
    }
    EXPECT_EQ(allocations - before, 0) << model.type->name();
  }
}

}  // namespace
}  // namespace bodesmith::hysteresis

namespace bench {
namespace {

TEST(VirtualStage, HasLoopsThatShrinkWithRateAndMirrorsNoModel) {
  VirtualStageSettings settings = VirtualStageSettings::piezoceramic();
  settings.noise_rms = 0.0;
  double before = 1e9;
  for (const double f : {1.0, 10.0, 100.0}) {
    VirtualStage stage(settings);
    stage.reset(0.0);
    double low = 1e9, high = -1e9;
    for (int i = 1; i <= 6 * 500; ++i) {
      const double y =
          stage.step(60.0 - 60.0 * std::cos(2 * std::numbers::pi * i / 500.0), 1.0 / (500.0 * f));
      if (i > 5 * 500) {
        low = std::min(low, y);
        high = std::max(high, y);
      }
    }
    EXPECT_LT(high - low, before) << f;
    before = high - low;
  }
  EXPECT_NEAR(before, 30.0, 8.0);
}

TEST(VirtualStage, LinearPartsHaveTheirFrequencyResponse) {
  VirtualStageSettings settings;
  settings.alpha = 1e-9;  // no memory
  settings.slope = 1.0;
  settings.asymmetry = 0.0;
  settings.rate_beta = 0.3;
  settings.rate_from_hz = 10.0;
  settings.rate_to_hz = 1000.0;
  settings.amplifier_hz = 500.0;
  settings.resonance_hz = 800.0;
  settings.damping_ratio = 0.2;
  VirtualStage stage(settings);
  const double f = 100.0, w = 2 * std::numbers::pi * f;
  const int n = 1000;
  stage.reset(0.0);
  std::complex<double> sum = 0.0;
  for (int i = 1; i <= 80 * n; ++i) {
    const double y = stage.step(std::sin(w * i / (n * f)), 1.0 / (n * f));
    if (i > 70 * n) sum += y * std::polar(1.0, -w * i / (n * f));
  }
  sum *= std::complex<double>(0.0, 2.0 / (10.0 * n));
  const std::complex<double> s(0.0, w), lag = 1.0 / (1.0 + s / (2 * std::numbers::pi * 500.0));
  const double w0 = 2 * std::numbers::pi * 800.0;
  const std::complex<double> mass = w0 * w0 / (s * s + 0.4 * w0 * s + w0 * w0);
  const std::complex<double> rate =
      std::pow((1.0 + s / (2 * std::numbers::pi * 1000.0)) / (1.0 + s / (2 * std::numbers::pi * 10.0)), 0.3);
  EXPECT_LT(std::abs(sum / (lag * mass * rate) - 1.0), 0.01);
}

TEST(VirtualStage, SameSeedSameNoise) {
  VirtualStage a(VirtualStageSettings::pusher()), b(VirtualStageSettings::pusher());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.step(0.5 * i, 1e-3), b.step(0.5 * i, 1e-3));
}

}  // namespace
}  // namespace bench
