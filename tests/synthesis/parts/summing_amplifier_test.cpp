#include "synthesis/parts/summing_amplifier.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"

namespace bodesmith::synthesis {
namespace {

TEST(WeightFor, IsWithinTheResistorsOrNearEnough) {
  EXPECT_EQ(weight_for(-0.5, 10e3, 1.0), 20e3);
  EXPECT_EQ(weight_for(0.0, 10e3, 1.0), 0.0);
  EXPECT_EQ(weight_for(20.0, 10e3, 1.0), std::nullopt);  // 500 ohm
  // 10 Mohm makes 0.001: what is nearer to nothing is left out.
  EXPECT_EQ(weight_for(0.0008, 10e3, 2.5), kGreatestOhm);
  EXPECT_EQ(weight_for(0.0003, 10e3, 2.5), 0.0);
  EXPECT_EQ(weight_for(0.004, 100e3, 2.5), std::nullopt);  // 15 mV
}

TEST(SumSearch, ASmallTermOfALargeVoltageIsMadeAsWellAsItGoes) {
  // Of a drawn stage: 0.0009 of a reference of 2.5 V beside gains of some hundredths.
  const std::vector<double> gains = {-0.0135, -0.0009};
  std::vector<std::vector<double>> rows;
  for (const double x : {0.0, 0.5, 1.0}) rows.push_back({-x, 2.5, gains[0] * -x + gains[1] * 2.5});
  const SummingDesign design = search_sum(gains, rows, Series::named("E96"), "control voltage");
  for (const std::vector<double>& row : rows)
    EXPECT_NEAR(design.gains[0] * row[0] + design.gains[1] * row[1], row[2], 2e-3);
  EXPECT_THROW(search_sum({-1000.0, -0.01}, {{1.0, 2.5, -1000.025}}, Series::named("E96"), "control"),
               DesignError);
}

TEST(SumSearch, TheExactResistorsMakeTheGainsAndTheRealisedOnesNearThem) {
  const std::vector<std::vector<double>> all = {
      {0.5, -0.25}, {2.0, 0.3, -0.7}, {-1.0, -0.5}, {0.2, 0.1, 0.05}, {0.3, -3.0, 1.1}};
  for (const std::vector<double>& gains : all) {
    std::vector<std::vector<double>> rows;
    for (std::size_t k = 0; k < gains.size(); ++k) {
      std::vector<double>& row = rows.emplace_back(gains.size() + 1, 0.0);
      row[k] = 1.0;
      row.back() = gains[k];
    }
    const SummingDesign design = search_sum(gains, rows, Series::named("E96"), "sum");
    const std::vector<double> exact = summing_gains(design.exact, gains);
    for (std::size_t k = 0; k < gains.size(); ++k) {
      EXPECT_NEAR(exact[k], gains[k], 1e-9) << gains[0];
      EXPECT_NEAR(design.gains[k], gains[k], 0.02 * std::abs(gains[k])) << gains[0];
    }
  }
}

TEST(SummingResistors, ANearlyStraightPolynomialIsMade) {
  const std::vector<double> wanted = {0.3, -0.3, 2e-4};
  std::vector<std::vector<double>> rows;
  for (const double x : {0.25, 0.5, 0.75, 1.0})
    rows.push_back({x, x * x, x * x * x, wanted[0] * x + wanted[1] * x * x + wanted[2] * x * x * x});
  const SummingDesign design = search_sum(wanted, rows, Series::named("E96"), "powers");
  for (const double x : {0.25, 0.5, 1.0}) {
    double off = 0.0;
    for (int k = 2; k >= 0; --k) {
      const auto at = static_cast<std::size_t>(k);
      off = (off + design.gains[at] - wanted[at]) * x;
    }
    EXPECT_NEAR(off, 0.0, 1e-3);
  }
}

}  // namespace
}  // namespace bodesmith::synthesis
