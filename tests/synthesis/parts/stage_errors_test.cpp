#include "synthesis/parts/stage_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lti/steep_flanks.hpp"

namespace bodesmith::synthesis {
namespace {

/// b0, b1, b2, a0, a1, a2 as they are given.
class AnyBiquad final : public StageForm {
 public:
  explicit AnyBiquad(const Section& section) { wanted_ = Biquad::from_section(section); }
  Biquad transfer(std::span<const double> v) const override { return {v[0], v[1], v[2], v[3], v[4], v[5]}; }
  std::optional<std::vector<double>> design(std::span<const double>) const override { return std::nullopt; }
};

TEST(StageErrors, AreTheWeightedLogarithmsOfTheQuotient) {
  Sections sections;
  sections.sections = {{3.0, {{-100.0, 900.0}, {-100.0, -900.0}}, {{-200.0, 970.0}, {-200.0, -970.0}}}};
  SearchGrid grid(sections, {Hertz{10}, Hertz{3000}}, 40);
  for (std::size_t k = 0; k < grid.at.size(); ++k) grid.weight[k] = 1.0 / static_cast<double>(k + 1);
  const AnyBiquad form(sections.sections[0]);
  const StageErrors errors(form, grid);
  for (const std::vector<double>& values :
       {std::vector<double>{2e6, -3e3, 1.0, 9e5, 7e2, 1.0}, {1e-230, 0.0, 0.0, 1.0, 1e-3, 0.0}}) {
    const Biquad h = form.transfer(values);
    const auto got = errors.logarithms(values);
    double worst = 0.0;
    for (std::size_t k = 0; k < grid.at.size(); ++k) {
      const std::complex<long double> ratio =
          std::complex<long double>(h.response(grid.at[k].rad_s())) /
          std::complex<long double>(form.wanted().response(grid.at[k].rad_s()));
      const std::complex<double> exact(std::log(ratio));
      EXPECT_NEAR(std::abs(got[k] - grid.weight[k] * exact), 0.0, 2e-15 * std::max(1.0, std::abs(exact)))
          << k;
      worst = std::max(worst, std::pow(grid.weight[k] * static_cast<double>(std::abs(ratio - 1.0L)), 2.0));
    }
    EXPECT_NEAR(errors.worst_square(values, HUGE_VAL), worst, 1e-13 * worst);
    // Stops early, but never below what was asked for.
    EXPECT_GT(errors.worst_square(values, 0.5 * worst), 0.5 * worst);
  }
}

/// Where |d ln H/d ln f| is above a number, a point weighs that number over it.
TEST(SearchGrid, SteepFlanksWeighLess) {
  Sections sections;
  sections.sections = {{3.0, {{-4.0, 900.0}, {-4.0, -900.0}}, {{-30.0, 970.0}, {-30.0, -970.0}}},
                       {1.0, {}, {{-2.0, 5000.0}, {-2.0, -5000.0}}}};
  const SearchGrid grid(sections, {Hertz{10}, Hertz{3000}}, 40);
  int steep = 0;
  for (std::size_t k = 0; k < grid.at.size(); ++k) {
    constexpr double kStep = 1e-6;
    const auto above = sections.response(Hertz{grid.at[k].value * (1.0 + kStep)}.rad_s());
    const auto below = sections.response(Hertz{grid.at[k].value * (1.0 - kStep)}.rad_s());
    const double slope = std::abs(std::log(above / below)) / (2.0 * kStep);
    EXPECT_NEAR(grid.weight[k], std::min(1.0, kFlankRate / slope), 1e-6) << grid.at[k].value;
    steep += grid.weight[k] < 1.0;
  }
  EXPECT_GT(steep, 5);
  EXPECT_LT(steep, static_cast<int>(grid.at.size()) - 5);
}

}  // namespace
}  // namespace bodesmith::synthesis
