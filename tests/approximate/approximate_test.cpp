#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "approximate/approximate.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

Cascade paper_cascade() {
  Cascade out;
  const double f[] = {1, 10, 20, 60, 100};
  const double beta[] = {-0.0428, 1.0245, -1.2113, 2.2908};
  for (int i = 0; i < 4; ++i)
    out.terms.push_back({1.0 / Hertz{f[i]}.rad_s().value, f[i] / f[i + 1], beta[i]});
  return out;
}

// More splits of the poles than can be tried: as for a third-octave curve of 29 bands, which took minutes without an end.
TEST(ApproximateCascade, OfManyTermsNoneCanLoseAPole) {
  Cascade cascade;
  for (int i = 0; i < 29; ++i) {
    const double f = 20.0 * std::pow(1.25, i);
    cascade.terms.push_back(
        {1.0 / Hertz{f}.rad_s().value, 0.8, (i % 2 == 0 ? 1.0 : -1.0) * (0.6 + 0.15 * i)});
  }
  ApproximationOptions options;
  options.max_error_db = 0.1;
  const auto made = approximate_cascade(cascade, options);
  ASSERT_TRUE(made.limit_met());
  const auto error_db = [&](std::size_t fewer_of) {
    Sections sections;
    for (std::size_t i = 0; i < made.terms.size(); ++i) {
      const int order = made.terms[i].order - (i == fewer_of ? 1 : 0);
      const auto term = std::get<TermApproximation>(try_approximate_term(cascade.terms[i], options, order));
      sections.sections.insert(sections.sections.end(), term.sections.begin(), term.sections.end());
    }
    return approximation_error(sections, cascade).everywhere_db;
  };
  for (std::size_t i = 0; i < made.terms.size(); ++i) {
    if (made.terms[i].order > 1) {
      EXPECT_GT(error_db(i), 0.1 * (1.0 - 2e-3)) << i;
    }
  }
}

TEST(ApproximateCascade, MeetsTheLimitWithTheFewestPoles) {
  for (const double limit : {0.3, 0.01, 1e-4}) {
    ApproximationOptions options;
    options.max_error_db = limit;
    const auto made = approximate_cascade(paper_cascade(), options);
    EXPECT_TRUE(made.limit_met());
    EXPECT_LE(made.error.everywhere_db, limit);
    // No split of one pole fewer meets it.
    const int poles = made.sections.pole_count();
    for (int a = 1; a < poles; ++a) {
      for (int b = 1; a + b < poles; ++b) {
        for (int c = 1; a + b + c < poles - 1; ++c) {
          const int d = poles - 1 - a - b - c;
          if (b < 2 || c < 2 || d < 3) continue;
          const Cascade cascade = paper_cascade();
          Sections sections;
          const int order[] = {a, b, c, d};
          for (size_t i = 0; i < 4; ++i) {
            static std::map<std::pair<size_t, int>, TermApproximation> known;
            auto& term = known[{i, order[i]}];
            if (term.order == 0) term = value_or_throw(try_approximate_term(cascade.terms[i], {}, order[i]));
            sections.sections.insert(sections.sections.end(), term.sections.begin(), term.sections.end());
          }
          ASSERT_GT(approximation_error(sections, cascade).everywhere_db, 0.999 * limit) << a << b << c << d;
        }
      }
    }
  }
}

// The errors of neighbours add at their plateaus. The wide term's, worst by itself, falls slowly with its poles, the narrow
// one's at once: poles given to the worst end at 8 and 2.
TEST(ApproximateCascade, TakesPolesAwayWhereAnotherSplitNeedsFewer) {
  Cascade cascade;
  cascade.terms = {{100.0, 1e-4, 0.5}, {0.16, 0.34, 0.92}};
  ApproximationOptions options;
  options.max_error_db = 0.019;
  const auto made = approximate_cascade(cascade, options);
  EXPECT_TRUE(made.limit_met());
  EXPECT_EQ(made.terms[0].order, 7);
  EXPECT_EQ(made.terms[1].order, 2);
}

TEST(ApproximateCascade, SaysWhenALimitCannotBeMet) {
  Cascade wide;
  wide.terms.push_back({1.0, 1e-6, 0.5});
  ApproximationOptions options;
  options.max_error_db = 1e-9;
  options.max_order = 6;
  const auto made = approximate_cascade(wide, options);
  EXPECT_FALSE(made.limit_met());
  EXPECT_EQ(made.sections.pole_count(), 6);
}

TEST(ApproximateCascade, ErrorIsMeasuredEverywhere) {
  const auto made = approximate_cascade(paper_cascade(), {.method = "oustaloup", .order = 5});
  double worst = 0.0;
  double worst_deg = 0.0;
  for (const Hertz f : log_grid({Hertz{1e-4}, Hertz{1e6}}, 20001)) {
    const auto ratio = made.sections.response(f.rad_s()) / paper_cascade().response(f.rad_s());
    worst = std::max(worst, std::abs(to_decibel(std::abs(ratio))));
    worst_deg = std::max(worst_deg, std::abs(to_degrees(std::arg(ratio))));
  }
  EXPECT_NEAR(made.error.everywhere_db / worst, 1.0, 1e-3);
  EXPECT_NEAR(made.error.everywhere_deg / worst_deg, 1.0, 1e-3);
  EXPECT_LE(made.sections.error->band.from.value, 1.0 + 1e-12);
  EXPECT_GE(made.sections.error->band.to.value, 100.0 * (1.0 - 1e-12));
}

TEST(ApproximateCascade, PassesOverTermsOfOrderZeroAndKeepsPlainGains) {
  Cascade cascade = paper_cascade();
  cascade.gain = 2.0;
  cascade.terms[1].beta = 0.0;
  const auto made = approximate_cascade(cascade, {.order = 3});
  EXPECT_EQ(made.terms.size(), 3u);
  EXPECT_NEAR(made.sections.dc_gain(), 2.0, 1e-3);
  cascade.terms.clear();
  const auto plain = approximate_cascade(cascade, {});
  EXPECT_TRUE(plain.sections.sections.empty());
  EXPECT_EQ(plain.sections.gain, 2.0);
  EXPECT_THROW(value_or_throw(try_approximate_term({1.0, 0.1, 0.5}, {}, 0)), InputError);
}

TEST(Cascade, ABandWhoseTruePowerIsZeroIsLeftOut) {
  // What rounding leaves of it after an interpolation.
  Cascade cascade;
  cascade.terms = {{0.1, 0.1, 1e-15}, {0.01, 0.1, 0.5}, {0.001, 0.1, -3e-16}};
  for (const char* method : {"minimax", "oustaloup", "matsuda", "carlson", "pade"}) {
    ApproximationOptions options;
    options.method = method;
    options.order = 4;
    const CascadeApproximation got = approximate_cascade(cascade, options);
    EXPECT_EQ(got.terms.size(), 1u) << method;
    EXPECT_FALSE(got.sections.sections.empty()) << method;
  }
}

}  // namespace
}  // namespace bodesmith
