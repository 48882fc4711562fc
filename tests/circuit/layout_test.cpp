#include "circuit/layout.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"

namespace bodesmith {
namespace {

Disturbance seed_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  return d;
}

double horner(const std::vector<double>& a, double x) {
  double out = 0.0;
  for (size_t k = a.size(); k-- > 0;) out = (out + a[k]) * x;
  return out;
}

TEST(Layout, SeedPolynomialsShareTwoMultipliers) {
  const DisturbanceLayout layout = layout_disturbance(seed_disturbance());
  EXPECT_EQ(layout.multipliers.size(), 2u);
  EXPECT_LT(layout.max_error_percent, 0.04);
  for (const LayoutNode& node : layout.nodes) {
    EXPECT_LE(std::max(std::abs(node.lowest_v), std::abs(node.highest_v)), 1.0 + 1e-9) << node.name;
  }
  EXPECT_TRUE(layout.warnings.empty());
}

TEST(Layout, MultiplierCountsByDegree) {
  // All powers up to the degree: one multiplier a power; the top power alone: an addition chain.
  const int top_alone[] = {0, 0, 1, 2, 2, 3, 3, 4};
  for (int degree = 1; degree <= 7; ++degree) {
    std::vector<double> all(static_cast<size_t>(degree), 0.1), alone(static_cast<size_t>(degree), 0.0);
    alone.back() = 0.3;
    EXPECT_EQ(layout_polynomials({{"up", all}}).multipliers.size(), static_cast<size_t>(degree - 1));
    EXPECT_EQ(layout_polynomials({{"up", alone}}).multipliers.size(), static_cast<size_t>(top_alone[degree]))
        << degree;
  }
}

TEST(Layout, ExactPartsMakeThePolynomialExactly) {
  LayoutOptions options;
  options.resistors = Series::named("exact");
  for (const std::vector<double>& a :
       std::vector<std::vector<double>>{{0.5},
                                        {-0.5},
                                        {0.2, 0.3, -0.1},
                                        {-0.1, -0.2, -0.3},
                                        {0, 0, 0.4},
                                        {0.3, -0.2, 0.1, 0.2, -0.15, 0.05, 0.02}}) {
    const DisturbanceLayout layout = layout_polynomials({{"up", a}, {"down", {-0.2, 0.1}}}, options);
    for (int i = 0; i <= 10; ++i) EXPECT_NEAR(layout.branches[0].value(i / 10.0), horner(a, i / 10.0), 1e-12);
  }
}

TEST(Layout, ABranchThatIsZeroGivesZero) {
  const DisturbanceLayout layout = layout_polynomials({{"up", {0.0, 0.0, 0.0}}, {"down", {-0.2, 0.1}}});
  EXPECT_EQ(layout.branches[0].value(0.7), 0.0);
}

TEST(Layout, RefusesWhatItCannotMake) {
  EXPECT_THROW(layout_polynomials({}), DesignError);
  EXPECT_THROW(layout_polynomials({{"a", std::vector<double>(8, 0.1)}}), DesignError);
  EXPECT_THROW(layout_polynomials({{"a", {NAN}}}), DesignError);
  EXPECT_THROW(layout_polynomials({{"a", {0.5, 1e-9}}}), DesignError);
}

}  // namespace
}  // namespace bodesmith
