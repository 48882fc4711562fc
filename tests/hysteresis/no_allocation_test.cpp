// step(), peek() and the inverses' step() allocate nothing: every operator new of this program is counted.
#include <gtest/gtest.h>

#include <cmath>

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
