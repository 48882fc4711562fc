// Sensitivities, limits and ranking of a divider and a low-pass in closed form.
#include "tolerance/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "synthesis/realise.hpp"

namespace bodesmith::tolerance {
namespace {

/// An inverting stage H = -(R2/R1)/(1 + s R2 C2) with its corner at 100 Hz.
Design low_pass() {
  Sections sections;
  sections.sections = {{2.0 * Hertz{100.0}.rad_s().value, {}, {-Hertz{100.0}.rad_s().value}}};
  synthesis::RealiseOptions options;
  options.resistors = options.capacitors = synthesis::Series::named("exact");
  return design_of_circuit(synthesis::realise(sections, options).circuit, sections, "low-pass",
                           OpAmps::ideal);
}

Options on(std::vector<Hertz> grid) {
  Options out;
  out.grid = std::move(grid);
  out.spread.resistor_percent = 1.0;
  out.spread.capacitor_percent = 5.0;
  out.spread.resistor_ppm_per_k = 100.0;
  out.spread.capacitor_ppm_per_k = 0.0;
  out.spread.temperature_low_c = -15.0;  // 40 K below, 20 K above
  out.spread.temperature_high_c = 45.0;
  return out;
}

TEST(Judge, LimitsSharesAndRangesOfALowPass) {
  const Design design = low_pass();
  const Options options = on({Hertz{1.0}, Hertz{100.0}, Hertz{1e4}});
  const Judge judge(design, options.grid);
  const Result got = expected_result(design, options, judge);
  // d ln H/d ln R2 = 1 - s T/(1 + s T), d ln H/d ln C2 = -s T/(1 + s T), d ln H/d ln R1 = -1; resistors 1 % + 40 K, capacitors 5 %.
  // Two more resistors turn the sign: +1 and -1.
  const double r = 1.0 + 100.0 * 40.0 * 1e-4, c = 5.0;
  const double neper = 0.2 / std::log(10.0);  // dB of a percent
  ASSERT_EQ(got.ranking.size(), design.parts.size());
  int ones = 0;
  double shares = 0.0;
  for (const PartRank& part : got.ranking) {
    shares += part.share;
    const bool is_c = part.part.starts_with("C");
    const bool is_r2 = part.part.starts_with("R2") && part.worst_hz.value == 1.0;
    if (is_c) {
      EXPECT_NEAR(part.worst_db, c * neper * (1.0 - 1e-4), 1e-4);
      EXPECT_EQ(part.worst_hz.value, 1e4);
      EXPECT_LT(part.db_per_percent, 0.0);
      // There everything else but R2, which does nothing, adds r^2 each.
      EXPECT_NEAR(part.share, c * c / (c * c + r * r * static_cast<double>(design.parts.size() - 2)), 1e-3);
    } else {
      EXPECT_NEAR(part.worst_db, r * neper, 1e-4) << part.part;
      EXPECT_NEAR(std::abs(part.db_per_percent), neper, 1e-4);
      ones += is_r2 ? 0 : 1;
    }
  }
  EXPECT_NEAR(shares, 1.0, 1e-12);
  EXPECT_TRUE(got.ranking[0].part.starts_with("C"));
  const double others = static_cast<double>(design.parts.size() - 2) * r;
  const double at_high = (c * (1.0 - 1e-4) + others + 1e-4 * r) * neper;
  EXPECT_NEAR(got.magnitude_db[2].high, 2.0 * at_high, 2e-3);
  EXPECT_EQ(got.magnitude_db[2].low, -got.magnitude_db[2].high);
  // At the corner R2 and C2 turn the phase by half of each: 1/2 rad a relative change.
  EXPECT_NEAR(got.phase_deg[1].high, 2.0 * (r + c) * 0.01 * 0.5 * 180.0 / std::numbers::pi, 1e-3);
  EXPECT_EQ(got.worst_db.high, got.magnitude_db[2].high);
  EXPECT_EQ(got.worst_deg.high, got.phase_deg[1].high);
  EXPECT_NEAR(got.worst_percent.high,
              100.0 * (std::pow(10.0, got.worst_db.high / 20.0) - 1.0 +
                       got.worst_deg.high * std::numbers::pi / 180.0),
              1e-9);
  // All at their limits: (1 + r)^k/((1 - r)^l (1 - c)) at the high end, whichever way is farther.
  EXPECT_GT(got.worst_case_db, at_high);
  EXPECT_LT(got.worst_case_db, 1.1 * at_high);
}

TEST(Judge, ADeviationIsThatOfThePoint) {
  const Design design = low_pass();
  const std::vector<Hertz> grid = {Hertz{1.0}, Hertz{10.0}};
  const Judge judge(design, grid);
  for (const auto& [db, deg] : {std::pair(0.5, 0.0), {-0.5, 0.0}, {0.0, 3.0}, {0.3, -2.0}, {0.0, 90.0}}) {
    const Judge::Worst got = judge(0, db, deg);
    const auto ratio = std::polar(std::pow(10.0, db / 20.0), deg * std::numbers::pi / 180.0);
    EXPECT_NEAR(got.db, std::abs(db), 1e-9);
    EXPECT_NEAR(got.deg, std::abs(deg), 1e-9);
    EXPECT_NEAR(got.percent, 100.0 * std::abs(ratio - 1.0), 1e-9);
  }
}

/// On the flank of a resonance a shift says less than the deviation itself; asked of a worst one found elsewhere, which may be larger
/// in one measure and less in another, the judge leaves each measure's maximum as it is.
TEST(Judge, TheMaximaDoNotDependOnWhatWasWorstBefore) {
  Design design = low_pass();
  design.wanted = [](Hertz f) {
    return 1.0 / (1.0 + Complex(0.0, 100.0) * (f.value / 100.0 - 100.0 / f.value));
  };
  const Judge judge(design, {Hertz{95.0}, Hertz{99.0}, Hertz{101.0}});
  const Judge::Worst far = judge(1, 3.0, 0.0);
  EXPECT_LT(far.percent, 0.6 * 100.0 * (std::pow(10.0, 3.0 / 20.0) - 1.0));
  for (const double db : {0.0, 20.0})
    for (const double deg : {0.0, 90.0})
      for (const double percent : {0.0, 200.0}) {
        const Judge::Worst least{db, deg, percent};
        for (const auto& [off, turned] : {std::pair(3.0, 0.0), {-3.0, 8.0}, {0.1, 30.0}}) {
          const Judge::Worst alone = judge(1, off, turned), after = judge(1, off, turned, least);
          EXPECT_EQ(std::max(db, after.db), std::max(db, alone.db)) << db << " " << deg << " " << percent;
          EXPECT_EQ(std::max(deg, after.deg), std::max(deg, alone.deg)) << db << " " << deg << " " << percent;
          EXPECT_EQ(std::max(percent, after.percent), std::max(percent, alone.percent))
              << db << " " << deg << " " << percent;
        }
      }
}

}  // namespace
}  // namespace bodesmith::tolerance
