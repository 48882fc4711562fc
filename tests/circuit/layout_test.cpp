#include "circuit/layout.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "circuit/layout_budget.hpp"

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

TEST(LayoutBudget, CausesByHand) {
  LayoutErrors errors;
  errors.output_offset_v = 10e-3;
  errors.opamp_offset_v = 1e-3;
  LayoutOptions options;
  options.resistors = Series::named("exact");
  const DisturbanceLayout layout = layout_disturbance(seed_disturbance(), options);
  const LayoutBudget budget = layout_budget(layout, errors);
  const auto cause = [&](const std::string& name) {
    for (const LayoutBudgetLine& line : budget.lines) {
      if (line.cause == name) return line.percent;
    }
    return std::vector<double>{};
  };
  // 10 mV at the output of M3 weigh a3 U^2 in d.
  const auto w3 = cause("M3, offset of W");
  ASSERT_EQ(w3.size(), 2u);
  EXPECT_NEAR(w3[0], 100.0 * 0.01 * 0.2887 * 1.05 * 1.05, 1e-9);
  EXPECT_NEAR(w3[1], 100.0 * 0.01 * 0.156 * 1.05 * 1.05, 1e-9);
  // The output amplifier's offset comes with its noise gain.
  EXPECT_NEAR(cause("output op-amp, offset")[0], 100.0 * 1e-3 * (1.0 + 1.0 / layout.branch_gain), 1e-9);
  EXPECT_EQ(budget.shared_multipliers, 2);
  EXPECT_EQ(budget.horner_multipliers, 4);
  EXPECT_EQ(budget.shared_depth, 2);
  EXPECT_GE(budget.worst_percent[0], budget.rss_percent[0]);
  // A Horner scheme's single offset by hand: 10 mV at W of the last product is U * 10 mV of d.
  EXPECT_GT(budget.horner_worst_percent, 100.0 * 0.01 * 1.05);
}

TEST(LayoutBudget, MultipliersByDegreeSharedAgainstHorner) {
  for (int degree = 2; degree <= 7; ++degree) {
    const std::vector<double> a(static_cast<size_t>(degree), 0.1);
    const LayoutBudget budget = layout_budget(layout_polynomials({{"up", a}, {"down", a}}));
    EXPECT_EQ(budget.shared_multipliers, degree - 1);
    EXPECT_EQ(budget.horner_multipliers, 2 * (degree - 1));
    EXPECT_LE(budget.shared_depth, degree <= 2 ? 1 : (degree <= 4 ? 2 : 3));
    EXPECT_EQ(budget.horner_depth, degree - 1);
  }
}

TEST(Layout, RefusesWhatItCannotMake) {
  EXPECT_THROW(layout_polynomials({}), DesignError);
  EXPECT_THROW(layout_polynomials({{"a", std::vector<double>(8, 0.1)}}), DesignError);
  EXPECT_THROW(layout_polynomials({{"a", {NAN}}}), DesignError);
  EXPECT_THROW(layout_polynomials({{"a", {0.5, 1e-9}}}), DesignError);
}

}  // namespace
}  // namespace bodesmith
