#include "approximate/merge_sections.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "lti/section_making.hpp"

#include "approximate/approximate.hpp"

namespace bodesmith {
namespace {

Cascade paper() {
  const double tau = 1.0 / (2.0 * std::numbers::pi);
  Cascade g;
  g.terms = {{tau / 1, 0.1, -0.0428},
             {tau / 10, 0.5, 1.0245},
             {tau / 20, 1.0 / 3.0, -1.2113},
             {tau / 60, 0.6, 2.2908}};
  return g;
}

TEST(MergeSections, LeavesOutPairsOnlyWithinTheLimit) {
  ApproximationOptions options;
  options.order = 3;
  const Cascade cascade = paper();
  const CascadeApproximation whole = approximate_cascade(cascade, options);
  int last = 100;
  for (const double limit : {1e-4, 0.01, 0.1, 0.5}) {
    const MergedSections merged = merge_sections(whole.sections, cascade, limit);
    if (merged.pairs_left_out > 0) {
      EXPECT_LE(merged.error.everywhere_db, limit);
      EXPECT_NEAR(approximation_error(merged.sections, cascade).everywhere_db, merged.error.everywhere_db,
                  1e-12);
    }
    EXPECT_EQ(merged.sections.pole_count() + merged.pairs_left_out, whole.sections.pole_count());
    EXPECT_LE(merged.sections.pole_count(), last) << "a looser limit must not need more poles";
    last = merged.sections.pole_count();
  }
  EXPECT_LT(last, whole.sections.pole_count()) << "half a decibel must save something";
}

TEST(MergeSections, AnExactlyCancellingPairGoesAlways) {
  const Cascade cascade = paper();
  ApproximationOptions options;
  options.order = 3;
  Sections doubled = approximate_cascade(cascade, options).sections;
  doubled.sections.push_back(Section::pole_zero(1.0, Hertz{30}.rad_s(), Hertz{30}.rad_s()));
  const double before = approximation_error(doubled, cascade).everywhere_db;
  const MergedSections merged = merge_sections(doubled, cascade, before * 1.0001 + 1e-9);
  EXPECT_GE(merged.pairs_left_out, 1);
}

TEST(MakeSections, BiquadsPairRealPoles) {
  ApproximationOptions options;
  options.order = 3;
  const Sections sections = approximate_cascade(paper(), options).sections;
  const Sections biquads = as_biquads(sections);
  EXPECT_LT(biquads.sections.size(), sections.sections.size());
  for (const double f : {0.1, 10.0, 1000.0}) {
    EXPECT_LT(std::abs(biquads.response(Hertz{f}.rad_s()) / sections.response(Hertz{f}.rad_s()) - 1.0),
              1e-12);
  }
}

}  // namespace
}  // namespace bodesmith
