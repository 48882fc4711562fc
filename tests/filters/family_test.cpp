// The families against their defining properties: half-power points, equal ripple, printed and integer coefficients.
#include "filters/family.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

Prototype prototype_of(const char* name, int order, double ripple_db = 0.5, double stop_db = 60.0) {
  return make_prototype(family_registry().get(name), {order, ripple_db, stop_db});
}

/// Largest and smallest attenuation between two frequencies, on a grid refined by golden sections at each extremum.
struct AttenuationRange {
  double least = INFINITY;
  double most = -INFINITY;
};
AttenuationRange attenuation_range(const Prototype& p, double from, double to) {
  AttenuationRange out;
  const int count = 4000;
  const auto w_at = [&](double i) { return from * std::pow(to / from, i / count); };
  for (int i = 0; i <= count; ++i) {
    const double a = p.attenuation_db(w_at(i));
    out.least = std::min(out.least, a);
    out.most = std::max(out.most, a);
    for (const double sign : {1.0, -1.0}) {
      double low = i - 1.0;
      double high = i + 1.0;
      if (i == 0 || i == count) continue;
      const double middle = sign * a;
      if (sign * p.attenuation_db(w_at(low)) > middle || sign * p.attenuation_db(w_at(high)) > middle)
        continue;
      for (int step = 0; step < 60; ++step) {
        const double third = (high - low) / 3.0;
        const bool right =
            sign * p.attenuation_db(w_at(low + third)) < sign * p.attenuation_db(w_at(high - third));
        (right ? low : high) += right ? third : -third;
      }
      const double extreme = p.attenuation_db(w_at(0.5 * (low + high)));
      out.least = std::min(out.least, extreme);
      out.most = std::max(out.most, extreme);
    }
  }
  return out;
}

TEST(Families, AreStableWithConjugatePairsAndReachGainOne) {
  for (const Family* family : family_registry().all()) {
    for (int order = family->only_even() ? 2 : 1; order <= family->highest_order();
         order += family->only_even() ? 2 : 1) {
      const Prototype p = make_prototype(*family, {order, 0.5, 60.0});
      ASSERT_EQ(p.poles.size(), static_cast<std::size_t>(order)) << family->name();
      std::complex<double> sum = 0.0;
      for (const auto& pole : p.poles) {
        EXPECT_LT(pole.real(), 0.0) << family->name() << order;
        sum += pole;
      }
      EXPECT_EQ(sum.imag(), 0.0) << family->name() << order;
      const double dc_db = family->has_ripple() && order % 2 == 0 ? -0.5 : 0.0;
      EXPECT_NEAR(to_decibel(std::abs(p.response(0.0))), dc_db, 2e-9) << family->name() << order;
    }
  }
}

TEST(Families, HalfPowerFamiliesAreThreeDecibelDownAtOne) {
  for (const Family* family : family_registry().all()) {
    const double at_one = make_prototype(*family, {6, 0.5, 60.0}).attenuation_db(1.0);
    switch (family->corner()) {
      case Family::Corner::half_power:
        EXPECT_NEAR(at_one, 10.0 * std::log10(2.0), 1e-11) << family->name();
        break;
      case Family::Corner::six_db:
        EXPECT_NEAR(at_one, 20.0 * std::log10(2.0), 1e-11) << family->name();
        break;
      case Family::Corner::ripple_edge:
        EXPECT_NEAR(at_one, 0.5, 1e-11) << family->name();
        break;
      case Family::Corner::stop_edge:
        EXPECT_NEAR(at_one, 60.0, 1e-9) << family->name();
        break;
    }
  }
}

TEST(Families, EllipticRipplesEquallyInBothBands) {
  for (const auto& [order, ripple, stop] :
       {std::tuple{3, 1.0, 40.0}, {4, 0.1, 50.0}, {7, 0.5, 60.0}, {10, 0.01, 100.0}}) {
    const Prototype p = prototype_of("elliptic", order, ripple, stop);
    const AttenuationRange pass = attenuation_range(p, 1e-3, 1.0);
    EXPECT_NEAR(pass.most, ripple, 1e-9 * ripple) << order;
    EXPECT_NEAR(pass.least, 0.0, 1e-10) << order;
    // The stop band begins where the attenuation first reaches `stop` and never falls below it.
    double low = 1.0;
    double high = std::abs(p.zeros.front());
    for (const auto& z : p.zeros) high = std::min(high, std::abs(z));
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (p.attenuation_db(middle) < stop ? low : high) = middle;
    }
    EXPECT_NEAR(attenuation_range(p, high, 1e3).least, stop, 1e-7) << order;
  }
}

TEST(Families, ChebyshevPolesGiveTheirPolynomials) {
  const double epsilon = std::sqrt(std::pow(10.0, 0.1) - 1.0);
  const Prototype one = prototype_of("chebyshev1", 9, 1.0);
  const double d = std::sqrt(std::pow(10.0, 4.0) - 1.0);
  const Prototype two = prototype_of("chebyshev2", 8, 1.0, 40.0);
  for (const double w : {0.1, 0.5, 0.9, 1.0, 1.3, 3.0}) {
    const auto t = [](int n, double x) {
      return std::abs(x) <= 1.0 ? std::cos(n * std::acos(x)) : std::cosh(n * std::acosh(x));
    };
    EXPECT_NEAR(one.attenuation_db(w), 10.0 * std::log10(1.0 + std::pow(epsilon * t(9, w), 2)), 1e-10) << w;
    EXPECT_NEAR(two.attenuation_db(w), 10.0 * std::log10(1.0 + std::pow(d / t(8, 1.0 / w), 2)), 1e-8) << w;
  }
}

TEST(Families, BesselPolesAreTheRootsOfIntegerPolynomials) {
  // theta_10, printed coefficients of s^0 … s^10.
  const double wanted[] = {654729075, 654729075, 310134825, 91891800, 18918900, 2837835,
                           315315,    25740,     1485,      55,       1};
  std::vector<std::complex<double>> coefficients{1.0};
  for (const auto& pole : bessel_poles(10)) {
    coefficients.insert(coefficients.begin(), 0.0);
    for (std::size_t i = 0; i + 1 < coefficients.size(); ++i) coefficients[i] -= pole * coefficients[i + 1];
  }
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    EXPECT_NEAR(coefficients[i].real() / wanted[i], 1.0, 1e-13) << i;
  }
  // Half-power poles of order 2 in tables.
  const Prototype p = prototype_of("bessel", 2);
  EXPECT_NEAR(p.poles[0].real(), -1.1016013306, 1e-9);
  EXPECT_NEAR(p.poles[0].imag(), 0.6360098247, 1e-9);
}

TEST(Families, ButterworthAndGaussianKeepTheirLaws) {
  const Prototype butterworth = prototype_of("butterworth", 30);
  for (const double w : {0.7, 0.99, 1.1, 2.0}) {
    EXPECT_NEAR(butterworth.attenuation_db(w), 10.0 * std::log10(1.0 + std::pow(w, 60.0)), 1e-9);
  }
  // Of a high order the Gaussian falls as exp(-w^2 ln 2).
  const Prototype gaussian = prototype_of("gaussian", 20);
  EXPECT_NEAR(gaussian.attenuation_db(2.0), 4.0 * 10.0 * std::log10(2.0), 1e-3);
}

TEST(Families, RefuseWhatTheyDoNotHave) {
  EXPECT_THROW(prototype_of("bessel", 0), InputError);
  EXPECT_THROW(prototype_of("bessel", 26), InputError);
  EXPECT_THROW(prototype_of("linkwitz-riley", 3), InputError);
  EXPECT_THROW(prototype_of("chebyshev1", 3, 0.0), InputError);
  EXPECT_THROW(prototype_of("chebyshev2", 3, 1.0, NAN), InputError);
  EXPECT_THROW(prototype_of("elliptic", 3, 3.0, 2.0), InputError);
}

}  // namespace
}  // namespace bodesmith::filters
