#include "approximate/approximation_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "approximate/approximate.hpp"
#include "approximate/log_symmetric.hpp"
#include "numeric/elliptic_k.hpp"

namespace bodesmith {
namespace {

/// E's rate: each further pole divides the error by this.
double factor_per_pole(double kappa) {
  const double k = 1.0 / kappa;
  return std::exp(2.0 * M_PI * std::comp_ellint_1(k) / std::comp_ellint_1(std::sqrt(1.0 - k * k)));
}

TEST(LimitLaw, IsTheSameForLeadAndLag) {
  for (const double beta : {0.1, 0.5, 1.7, 2.9}) {
    for (const int n : {3, 6}) {
      const double lead = minimax_limit_db(50.0, beta, n);
      EXPECT_NEAR(minimax_limit_db(50.0, -beta, n) / lead, 1.0, 1e-12) << beta << " " << n;
    }
  }
}

TEST(LimitLaw, FallsWithEveryPoleAndRisesWithTheBand) {
  for (const double beta : {0.05, 0.5, 0.95, 1.5, 2.5}) {
    for (int n = 3; n < 12; ++n) {
      double narrower = 0.0;
      for (const double kappa : {1.1, 2.0, 10.0, 1e3, 1e6}) {
        const double here = minimax_limit_db(kappa, beta, n);
        EXPECT_GT(here, narrower) << kappa << " " << beta << " " << n;
        EXPECT_LT(minimax_limit_db(kappa, beta, n + 1), here) << kappa << " " << beta << " " << n;
        narrower = here;
      }
    }
  }
}

// The Gamma functions' share tends to 1, so for many poles the elliptic integrals alone set the rate.
TEST(LimitLaw, GoesDownGeometrically) {
  for (const double kappa : {3.0, 100.0, 1e5}) {
    const double ratio = minimax_limit_db(kappa, 0.5, 30) / minimax_limit_db(kappa, 0.5, 31);
    EXPECT_NEAR(ratio / factor_per_pole(kappa), 1.0, 1e-3) << kappa;
  }
}

TEST(LimitLaw, VanishesForWholePowers) {
  EXPECT_EQ(minimax_limit_db(10.0, 0.0, 0), 0.0);
  EXPECT_EQ(minimax_limit_db(10.0, 1.0, 2), 0.0);
  EXPECT_EQ(minimax_limit_db(10.0, -3.0, 3), 0.0);
  // Continuously: proportional to the distance from the whole power.
  EXPECT_NEAR(minimax_limit_db(10.0, 1.0 + 1e-6, 4) / minimax_limit_db(10.0, 1.0 + 1e-7, 4), 10.0, 1e-3);
}

// What is stated in the band of the corners, everywhere, and where, against a finer scan by complex division.
TEST(ApproximationError, IsTheLargestInItsBandAndEverywhere) {
  Cascade cascade;
  cascade.terms = {{1e-2, 0.01, 0.4}, {1e-4, 0.1, -0.3}};
  Sections sections = approximate_cascade(cascade, {}).sections;
  // Rest and high frequencies off by 12 %, so that the band is better than the rest.
  for (const double turn : {1.0, 3.0}) {
    sections.sections.front().zeros.front() *= 1.0 + 0.12 / turn;
    const ApproximationError got = approximation_error(sections, cascade);
    double band_db = 0.0, band_deg = 0.0, db = 0.0, deg = 0.0, worst = 0.0;
    for (int i = 0; i <= 40000; ++i) {
      const Hertz f{got.band.from.value / 100.0 *
                    std::pow(1e4 * got.band.to.value / got.band.from.value, i / 4e4)};
      const Complex ratio = sections.response(f.rad_s()) / cascade.response(f.rad_s());
      const double here_db = std::abs(to_decibel(std::abs(ratio))),
                   here_deg = std::abs(to_degrees(std::arg(ratio)));
      if (here_db > db) db = here_db, worst = f.value;
      deg = std::max(deg, here_deg);
      if (f < got.band.from || f > got.band.to) continue;
      band_db = std::max(band_db, here_db);
      band_deg = std::max(band_deg, here_deg);
    }
    EXPECT_NEAR(got.band_db, band_db, 1e-3 * band_db);
    EXPECT_NEAR(got.band_deg, band_deg, 1e-3 * band_deg);
    EXPECT_NEAR(got.everywhere_db, db, 1e-3 * db);
    EXPECT_NEAR(got.everywhere_deg, deg, 1e-3 * deg);
    const auto at = [&](double hz) {
      return to_decibel(std::abs(sections.response(Hertz{hz}.rad_s()) / cascade.response(Hertz{hz}.rad_s())));
    };
    EXPECT_NEAR(std::abs(at(got.worst.value)), std::abs(at(worst)), 1e-3 * db);
  }
}

// No method does better where the law holds to a percent.
TEST(LimitLaw, IsALimit) {
  for (const Method* method : method_registry().all()) {
    for (const double beta : {0.3, 0.5, 0.8}) {
      ApproximationOptions options;
      options.method = method->name();
      const auto made = try_approximate_term({1.0, 1e-2, beta}, options, 4);
      if (!std::holds_alternative<TermApproximation>(made)) continue;
      const auto& approximation = std::get<TermApproximation>(made);
      EXPECT_EQ(approximation.limit_law_db, minimax_limit_db(100.0, beta, 4));
      EXPECT_GT(approximation.error.everywhere_db, 0.99 * approximation.limit_law_db) << method->name();
    }
  }
}

// The law needs an order above |beta| - 1: a whole power's term of that order has the limit 0, one of less has none.
TEST(LimitLaw, IsThereForEveryOrderThatHoldsTheWholePower) {
  for (const auto& [order, beta] : {std::pair(1, 0.5), {1, 0.9}, {2, 1.5}, {2, 1.9}, {3, 0.5}}) {
    const auto made = try_approximate_term({1.0, 1e-2, beta}, {}, order);
    ASSERT_TRUE(std::holds_alternative<TermApproximation>(made)) << order << " " << beta;
    EXPECT_EQ(std::get<TermApproximation>(made).limit_law_db, minimax_limit_db(100.0, beta, order));
  }
}

TEST(LimitLaw, SmallestOrderIsItsInverse) {
  for (const double kappa : {2.0, 10.0, 1e4}) {
    for (const double beta : {0.2, 0.5, 1.3}) {
      for (const double max_db : {1.0, 0.03, 1e-4}) {
        const int n = minimax_order(kappa, beta, max_db, 40);
        ASSERT_LE(n, 40);
        EXPECT_LE(minimax_limit_db(kappa, beta, n), max_db);
        if (n - 1 >= beta) {
          EXPECT_GT(minimax_limit_db(kappa, beta, n - 1), max_db);
        }
      }
    }
  }
  EXPECT_EQ(minimax_order(10.0, 0.5, 0.03, 12), 2);
  EXPECT_EQ(minimax_order(1e6, 0.5, 1e-9, 12), 13);
}

TEST(LimitLaw, RefusesWhatItIsNotMeantFor) {
  EXPECT_THROW(minimax_limit_db(1.0, 0.5, 2), std::domain_error);
  EXPECT_THROW(minimax_limit_db(10.0, 3.5, 2), std::domain_error);
  EXPECT_THROW(minimax_limit_db(10.0, 0.5, -1), std::domain_error);
}

TEST(Elliptic, CompleteIntegralOfTheFirstKind) {
  for (const double k : {0.0, 0.1, 0.5, 0.9, 0.999}) {
    const double complement = std::sqrt((1.0 - k) * (1.0 + k));
    EXPECT_NEAR(static_cast<double>(complete_elliptic_k(complement)) / std::comp_ellint_1(k), 1.0, 1e-13);
  }
  // The lemniscate: K(1/sqrt 2) = Gamma(1/4)^2 / (4 sqrt pi).
  const long double gamma = std::tgamma(0.25L);
  EXPECT_NEAR(
      static_cast<double>(complete_elliptic_k(std::sqrt(0.5L)) * 4.0L * std::sqrt(M_PIl) / (gamma * gamma)),
      1.0, 1e-17);
}

TEST(Elliptic, FunctionsKeepTheirIdentities) {
  for (const long double complement : {1.0L, 0.8L, 0.1L, 1e-4L}) {
    const long double square = (1.0L - complement) * (1.0L + complement);  // k^2
    const long double quarter = complete_elliptic_k(complement);
    EXPECT_NEAR(static_cast<double>(jacobi_elliptic(quarter, complement).sn), 1.0, 1e-15);
    for (const long double part : {0.1L, 0.37L, 0.49L}) {
      const auto e = jacobi_elliptic(part * quarter, complement);
      EXPECT_NEAR(static_cast<double>(e.sn * e.sn + e.cn * e.cn), 1.0, 1e-15);
      EXPECT_NEAR(static_cast<double>(e.dn * e.dn + square * e.sn * e.sn), 1.0, 1e-15);
      // sn 2u = 2 sn cn dn / (1 - k^2 sn^4).
      const long double fourth = e.sn * e.sn * e.sn * e.sn;
      EXPECT_NEAR(static_cast<double>(jacobi_elliptic(2.0L * part * quarter, complement).sn),
                  static_cast<double>(2.0L * e.sn * e.cn * e.dn / (1.0L - square * fourth)), 1e-14);
    }
  }
  // k = 0: the circle.
  EXPECT_NEAR(static_cast<double>(jacobi_elliptic(0.7L, 1.0L).sn), std::sin(0.7), 1e-15);
}

}  // namespace
}  // namespace bodesmith
