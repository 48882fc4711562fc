#include "circuit/ladders/fractional_element.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace bodesmith::circuit {
namespace {

const RcLadder* const kLadders[] = {&foster1(), &foster2(), &cauer1(), &cauer2()};

FractionalElement exact(double alpha, int order, const RcLadder& ladder) {
  const Series any = Series::named("exact");
  return make_fractional_element(alpha, 1e-6, {Hertz{10}, Hertz{1000}}, order, ladder, any, any);
}

// Four drawings of one rational function: the same impedance, and Oustaloup's own product.
TEST(FractionalElement, FourFormsAreOneImpedance) {
  for (const double alpha : {0.2, 0.5, 0.85}) {
    for (const int order : {1, 3, 6, 8}) {
      const FractionalElement first = exact(alpha, order, foster1());
      for (const RcLadder* ladder : kLadders) {
        const FractionalElement one = exact(alpha, order, *ladder);
        EXPECT_EQ(one.parts.size(), 2u * static_cast<size_t>(order) + 1u);
        for (const Hertz f : log_grid({Hertz{1}, Hertz{10000}}, 15)) {
          EXPECT_NEAR(std::abs(one.impedance(f.rad_s()) / first.impedance(f.rad_s()) - 1.0), 0.0, 1e-9)
              << alpha << " " << order << " " << ladder->name();
        }
      }
      const double low = 2.0 * M_PI * 1.0, high = 2.0 * M_PI * 10000.0;
      std::complex<double> z = std::pow(high, -alpha) / 1e-6;
      const std::complex<double> s(0.0, 500.0);
      for (int k = 1; k <= order; ++k) {
        z *= s + low * std::pow(high / low, (k - 0.5 + 0.5 * alpha) / order);
        z /= s + low * std::pow(high / low, (k - 0.5 - 0.5 * alpha) / order);
      }
      EXPECT_NEAR(std::abs(first.impedance({500.0}) / z - 1.0), 0.0, 1e-12);
    }
  }
}

TEST(FractionalElement, HoldsItsPhaseOverTheBand) {
  const FractionalElement one = exact(0.5, 8, foster1());
  for (const Hertz f : log_grid({Hertz{10}, Hertz{1000}}, 30)) {
    EXPECT_NEAR(to_degrees(std::arg(one.impedance(f.rad_s()))), -45.0,
                f.value < 25.0 || f.value > 400.0 ? 3.0 : 1.2);
    EXPECT_NEAR(to_decibel(std::abs(one.impedance(f.rad_s()) / one.ideal(f.rad_s()))), 0.0, 0.3);
  }
  const FractionalElement bought = make_fractional_element(0.5, 1e-6, {Hertz{10}, Hertz{1000}}, 8, foster1(),
                                                           Series::named("E96"), Series::named("E24"));
  for (const Hertz f : log_grid({Hertz{10}, Hertz{1000}}, 30)) {
    EXPECT_NEAR(to_decibel(std::abs(bought.impedance(f.rad_s()) / bought.ideal(f.rad_s()))), 0.0, 0.6);
  }
  EXPECT_NE(bought.subcircuit("cpe").find(".subckt cpe a b"), std::string::npos);
}

TEST(FractionalElement, RefusesWhatItCannotMake) {
  const Series any = Series::named("exact");
  const Band band{Hertz{10}, Hertz{1000}};
  EXPECT_THROW(make_fractional_element(1.0, 1e-6, band, 4, foster1(), any, any), DesignError);
  EXPECT_THROW(make_fractional_element(0.5, 0.0, band, 4, foster1(), any, any), DesignError);
  EXPECT_THROW(make_fractional_element(0.5, 1e-6, band, 0, foster1(), any, any), DesignError);
  EXPECT_THROW(make_fractional_element(0.5, 1e-6, {Hertz{10}, Hertz{10}}, 4, foster1(), any, any),
               DesignError);
}

}  // namespace
}  // namespace bodesmith::circuit
