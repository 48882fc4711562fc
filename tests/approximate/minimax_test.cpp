#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "approximate/approximate.hpp"
#include "approximate/approximation_error.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

using Extended = long double;

TermApproximation minimax_of(double kappa, double beta, int order) {
  return value_or_throw(try_approximate_term({1.0, 1.0 / kappa, beta}, {}, order));
}

/// The alternating extrema of the log magnitude error in nepers, in extended precision, from the written poles and
/// zeros; over all frequencies or between the corners.
std::vector<double> alternation(const TermApproximation& made, bool over_band) {
  const auto error = [&](const Extended& w) {
    Extended power = 1;
    for (const Section& section : made.sections) {
      power *= Extended(section.gain) * section.gain;
      for (std::size_t i = 0; i < section.poles.size(); ++i) {
        const Extended zero = section.zeros[i].real();
        const Extended pole = section.poles[i].real();
        power *= (w * w + zero * zero) / (w * w + pole * pole);
      }
    }
    const Extended a = w * Extended(made.term.lambda_s);
    const Extended b = a * Extended(made.term.x);
    return static_cast<double>(
        (std::log(power) - Extended(made.term.beta) * std::log((1 + a * a) / (1 + b * b))) / 2);
  };
  std::vector<double> heights;
  const double beyond = over_band ? 0.0 : 4.0;
  const double low = std::log(made.term.low_corner().value) - beyond;
  const double high = std::log(made.term.high_corner().value) + beyond;
  const double ends = over_band ? 0.0 : 20.0;  // for 0 and infinity
  const int steps = 400;
  for (int i = -1; i <= steps + 1; ++i) {
    const double at = i < 0 ? low - ends : i > steps ? high + ends : low + (high - low) * i / steps;
    const double e = error(std::exp(Extended(at)));
    if (heights.empty() || (e > 0.0) != (heights.back() > 0.0))
      heights.push_back(e);
    else if (std::abs(e) > std::abs(heights.back()))
      heights.back() = e;
  }
  return heights;
}

// Chebyshev's theorem: 2n + 2 alternating errors of one height prove the best approximation; their smallest
// bounds the best possible error from below (de la Vallee-Poussin). No code in common with the exchange.
TEST(Minimax, AlternatesAsOftenAsChebyshevsTheoremAsks) {
  for (const bool over_band : {false, true}) {
    ApproximationOptions options;
    options.over_band = over_band;
    for (const double kappa : {1.05, 10.0, 1e6}) {
      for (const double beta : {0.1, 0.93, 1.2, 1.9}) {
        for (const int order : {2, 7}) {
          // Too few poles for 1 < beta < 2 between the corners of a wide term.
          if (over_band && beta > 1.0 && kappa > 100.0) continue;
          const auto heights = alternation(
              value_or_throw(try_approximate_term({1.0, 1.0 / kappa, beta}, options, order)), over_band);
          double lowest = INFINITY;
          double highest = 0.0;
          for (const double h : heights) {
            lowest = std::min(lowest, std::abs(h));
            highest = std::max(highest, std::abs(h));
          }
          if (highest < 1e-12) continue;  // rounding of the roots to doubles shows
          ASSERT_EQ(heights.size(), static_cast<std::size_t>(2 * order + 2))
              << kappa << " " << beta << " " << order << " " << over_band;
          EXPECT_LT(highest / lowest, 1.01) << kappa << " " << beta << " " << order << " " << over_band;
        }
      }
    }
  }
}

TEST(Minimax, ARootBeyondAllFrequenciesIsRefused) {
  ApproximationOptions band;
  band.over_band = true;
  EXPECT_TRUE(std::holds_alternative<Refusal>(try_approximate_term({1.0, 1e-6, 1.7}, band, 2)));
  EXPECT_TRUE(std::holds_alternative<TermApproximation>(try_approximate_term({1.0, 1e-6, 1.7}, band, 8)));
}

// Beyond 1 the elliptic positions are far off, and what is left at ten poles is a millionth of that.
TEST(Minimax, ConvergesAtAnyRatioAndPower) {
  for (const bool over_band : {false, true}) {
    ApproximationOptions options;
    options.over_band = over_band;
    for (const double kappa : {12.0, 16.0, 25.0, 42.0, 1.5e7}) {
      for (const double beta : {0.35, 1.05, 1.33, 1.62, 1.92}) {
        for (const int order : {7, 9, 12}) {
          if (over_band && beta > 1.0 && kappa > 1e6) continue;
          EXPECT_TRUE(std::holds_alternative<TermApproximation>(
              try_approximate_term({1.0, 1.0 / kappa, beta}, options, order)))
              << kappa << " " << beta << " " << order << " " << over_band;
        }
      }
    }
  }
}

/// Above beta = 2 pairs are better than real roots, however wide the term is.
TEST(Minimax, PairsConvergeAtAnyRatio) {
  ApproximationOptions pairs;
  pairs.real_roots = false;
  for (const double kappa : {10.0, 1e3, 1e5, 1.5e7}) {
    for (const double beta : {2.05, 2.5, 2.95}) {
      for (const int order : {5, 9}) {
        const double error =
            value_or_throw(try_approximate_term({1.0, 1.0 / kappa, beta}, pairs, order)).error.everywhere_db;
        if (error < 1e-11) continue;  // rounding
        EXPECT_LT(error, minimax_of(kappa, beta, order).error.everywhere_db)
            << kappa << " " << beta << " " << order;
      }
    }
  }
}

TEST(Minimax, FollowsTheLimitLaw) {
  int seen = 0;
  for (const double kappa : {1.2, 3.0, 10.0, 1e3, 1e4}) {
    for (const double beta : {0.05, 0.5, 0.9}) {
      for (int order = 1; order <= 12; ++order) {
        const double law = minimax_limit_db(kappa, beta, order);
        if (law < 1e-11 || law > 0.1) continue;
        EXPECT_NEAR(minimax_of(kappa, beta, order).error.everywhere_db / law, 1.0, 0.006)
            << kappa << " " << beta << " " << order;
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 80);
}

TEST(Minimax, PublishedFigures) {
  // dB over all frequencies for beta = 1/2, found by an independent search.
  EXPECT_NEAR(minimax_of(10.0, 0.5, 2).error.everywhere_db, 0.022, 0.0005);
  EXPECT_NEAR(minimax_of(10.0, 0.5, 4).error.everywhere_db, 1.017e-4, 1e-6);
  EXPECT_NEAR(minimax_of(10.0, 0.5, 8).error.everywhere_db, 2.27e-9, 3e-11);
  EXPECT_NEAR(minimax_of(1e3, 0.5, 8).error.everywhere_db, 7.0e-4, 1e-5);
  EXPECT_NEAR(minimax_of(1e4, 0.5, 2).error.everywhere_db, 1.7, 0.05);
  // The whole term at once against a split-off power.
  EXPECT_NEAR(minimax_of(10.0, 1.9, 4).error.everywhere_db, 6.8e-5, 1e-6);
  EXPECT_NEAR(minimax_of(10.0, 0.9, 3).error.everywhere_db, 5.4e-4, 1e-5);
}

TEST(Minimax, EveryOrderEveryRatioRealAndStable) {
  for (const double kappa : {1.05, 1.7, 10.0, 100.0, 1e6}) {
    for (const double beta : {0.001, 0.5, 0.999, 1.001, 1.5, 1.999, 2.3, 4.0, 7.5, 10.0}) {
      for (int order = static_cast<int>(std::ceil(beta)); order <= 12; ++order) {
        const auto made = minimax_of(kappa, beta, order);
        int poles = 0;
        for (const Section& section : made.sections) {
          EXPECT_TRUE(section.is_stable());
          for (const auto& root : section.zeros) {
            EXPECT_EQ(root.imag(), 0.0);
            EXPECT_LT(root.real(), 0.0);
          }
          poles += static_cast<int>(section.poles.size());
        }
        // A whole power is exact with |beta| poles: more are not added.
        EXPECT_EQ(poles, beta == std::round(beta) ? static_cast<int>(beta) : order);
        EXPECT_TRUE(std::isfinite(made.error.everywhere_db));
      }
    }
  }
}

TEST(Minimax, LagIsTheReciprocalOfTheLead) {
  const auto lead = value_or_throw(try_approximate_term({0.01, 0.1, 0.7}, {}, 3));
  for (const FractionalLeadLag& same :
       {FractionalLeadLag{0.01, 0.1, -0.7}, FractionalLeadLag{0.001, 10.0, 0.7}}) {
    const auto lag = value_or_throw(try_approximate_term(same, {}, 3));
    for (const double w : {1.0, 50.0, 300.0, 1e4, 1e7}) {
      std::complex<double> product = 1.0;
      for (const Section& s : lead.sections) product *= s.response(RadPerSecond{w});
      for (const Section& s : lag.sections) product *= s.response(RadPerSecond{w});
      EXPECT_NEAR(std::abs(product - 1.0), 0.0, 1e-12);
    }
  }
}

TEST(Minimax, OverTheBandGainsDecibelsThere) {
  ApproximationOptions band;
  band.over_band = true;
  const FractionalLeadLag term{1.0, 1e-3, 0.5};
  const auto inside = value_or_throw(try_approximate_term(term, band, 4));
  const auto everywhere = value_or_throw(try_approximate_term(term, {}, 4));
  // Judged between the term's own corners.
  const auto worst = [&](const TermApproximation& made) {
    double db = 0.0;
    Sections sections;
    sections.sections = made.sections;
    for (const Hertz f : log_grid({term.low_corner().hz(), term.high_corner().hz()}, 400)) {
      db = std::max(db, std::abs(to_decibel(std::abs(sections.response(f.rad_s()))) -
                                 kDecibelPerNeper * term.log_magnitude(f.rad_s())));
    }
    return db;
  };
  EXPECT_LT(worst(inside), 0.9 * worst(everywhere));
  EXPECT_GT(inside.error.everywhere_db, everywhere.error.everywhere_db);
}

// Above beta = 2 the true minimax has complex pairs; the law holds for it, and real roots cost a multiple.
TEST(Minimax, ComplexPairsFollowTheLawAboveTwo) {
  ApproximationOptions complex;
  complex.real_roots = false;
  for (const double kappa : {1.667, 10.0}) {
    for (const double beta : {2.29, 3.5, 4.5, 5.5}) {
      for (int order = static_cast<int>(std::ceil(beta)) + 1; order <= 9; ++order) {
        const double law = minimax_limit_db(kappa, beta, order);
        if (law < 1e-11) continue;
        const auto made = value_or_throw(try_approximate_term({1.0, 1.0 / kappa, beta}, complex, order));
        EXPECT_NEAR(made.error.everywhere_db / law, 1.0, 0.05) << kappa << " " << beta << " " << order;
        for (const Section& section : made.sections) {
          EXPECT_TRUE(section.is_stable());
          for (const auto& zero : section.zeros) EXPECT_LT(zero.real(), 0.0);
        }
        EXPECT_GT(minimax_of(kappa, beta, order).error.everywhere_db, made.error.everywhere_db);
      }
    }
  }
}

// Best real roots above beta = 2, found by an independent many-start search over all real positions.
TEST(Minimax, RealRootsAboveTwoAreTheBestRealOnes) {
  EXPECT_NEAR(minimax_of(10, 2.5, 4).error.everywhere_db, 0.0024249, 3e-6);
  EXPECT_NEAR(minimax_of(10, 2.5, 3).error.everywhere_db, 0.043628, 5e-5);
  EXPECT_NEAR(minimax_of(10, 3.5, 6).error.everywhere_db, 0.00014487, 2e-7);
  EXPECT_NEAR(minimax_of(100, 5.5, 8).error.everywhere_db, 0.014529, 2e-5);
  EXPECT_NEAR(minimax_of(2, 2.29, 3).error.everywhere_db, 0.00010442, 1e-7);
}

// Fewer poles than |beta|: the best of all places for poles that lie together, and zeros that do, by trying them all.
TEST(Minimax, FewPolesMakeTheBestOfAHigherPower) {
  const auto expect_best = [](double kappa, double beta, int order) {
    SCOPED_TRACE(kappa);
    const FractionalLeadLag term{1.0, 1.0 / kappa, beta};
    const TermApproximation made = minimax_of(kappa, beta, order);
    const double centre = term.low_corner().value * std::sqrt(kappa);
    double best = INFINITY;
    for (int i = 0; i < 4000; ++i) {
      const double ratio = std::pow(kappa, 0.5 + (2.0 * beta / order - 0.5) * i / 4000.0);  // pole over zero
      const Section one = Section::pole_zero(1.0, {centre / std::sqrt(ratio)}, {centre * std::sqrt(ratio)});
      double low = 0.0;
      double high = 0.0;
      for (const Hertz f : log_grid({Hertz{1e-4}, Hertz{1e4}}, 81)) {
        const double e = order * to_decibel(std::abs(one.response(f.rad_s()))) -
                         kDecibelPerNeper * term.log_magnitude(f.rad_s());
        low = std::min(low, e);
        high = std::max(high, e);
      }
      best = std::min(best, 0.5 * (high - low));
    }
    EXPECT_NEAR(made.error.everywhere_db, best, 0.02 * best);
    ASSERT_EQ(made.sections.size(), std::size_t(order));
    EXPECT_TRUE(made.sections[0].is_stable());
  };
  expect_best(2.0, 1.6, 1);
  expect_best(40.0, 3.5, 2);
  expect_best(500.0, 2.6, 1);
}

}  // namespace
}  // namespace bodesmith
