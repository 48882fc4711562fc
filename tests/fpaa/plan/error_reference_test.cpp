#include "fpaa/plan/error_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <tuple>
#include <vector>

namespace bodesmith::fpaa {
namespace {

TEST(ErrorReference, ZerosOnTheAxisAreDamped) {
  const double w = 300.0;
  Sections notch;
  notch.sections = {{1.0, {{0.0, w}, {0.0, -w}}, {{-w, 0.0}, {-w, 0.0}}}};
  // (jw - z)(jw - z*) = 2 w 0.02 w at the zero, over 2 w^2.
  EXPECT_NEAR(error_reference(notch, {w}), 0.02, 1e-12);
  EXPECT_TRUE(is_near_zero(notch, {1.01 * w}));
  EXPECT_FALSE(is_near_zero(notch, {1.1 * w}));
  EXPECT_NEAR(error_reference(notch, {1.1 * w}), std::abs(notch.response(RadPerSecond{1.1 * w})), 1e-12);
}

TEST(ErrorReference, SharpRootsAreLookedAtSomeWidthsAround) {
  for (const double unit : {1.0, 1e3}) {
    const double w = 2.0 * M_PI * 100.0 * unit;
    const auto pair = [&](double damping) {
      const std::complex<double> root =
          w * std::complex<double>(-damping, std::sqrt(1.0 - damping * damping));
      Sections out;
      out.sections = {{1.0, {}, {root, std::conj(root)}}};
      return out;
    };
    const Band band{{10.0 * unit}, {1000.0 * unit}};
    const std::vector<Hertz> at = about_sharp_roots(pair(0.05), band);
    ASSERT_EQ(at.size(), 7U);
    const double middle = 100.0 * unit * std::sqrt(1.0 - 0.05 * 0.05);
    EXPECT_NEAR(at[3].value, middle, 1e-9 * middle);
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_NEAR(at[i].value + at[6 - i].value, 2.0 * middle, 1e-9 * middle);
    EXPECT_NEAR(at[6].value - at[0].value, 6.0 * 0.05 * 100.0 * unit, 1e-9 * middle);
    EXPECT_TRUE(about_sharp_roots(pair(0.3), band).empty());
    EXPECT_EQ(about_sharp_roots(pair(0.05), {{10.0 * unit}, {100.0 * unit}}).size(), 4U);
    // The sharpest as if they were damped by a fiftieth.
    const std::vector<Hertz> sharp = about_sharp_roots(pair(1e-6), band);
    EXPECT_NEAR(sharp[6].value - sharp[0].value, 6.0 * 0.02 * 100.0 * unit, 1e-6 * middle);
  }
}

TEST(ErrorReference, FarCornersDoNotWidenTheBand) {
  Sections s;
  s.sections = {{1.0, {-0.1}, {-2.0 * M_PI * 21.0}}, {1.0, {-1e8}, {-2.0 * M_PI * 1000.0}}};
  EXPECT_NEAR(judged_band(s).from.value, 0.1 / (2.0 * M_PI), 1e-9);
  s.error = Sections::Error{{{20.0}, {20000.0}}, 0.0, std::nullopt, 0.0};
  EXPECT_NEAR(judged_band(s).from.value, 20.0, 1e-9);
  EXPECT_NEAR(judged_band(s).to.value, 20000.0, 1e-6);
}

/// A high pass is judged over the mirror image of its low pass's band (s -> 1/s), what passes everything a decade both ways.
TEST(ErrorReference, OneCornerIsJudgedWhereItPasses) {
  const double w = 2.0 * M_PI * 100.0;
  const Section low{w * w, {}, {{-w, w}, {-w, -w}}}, high{1.0, {0.0, 0.0}, {{-w, w}, {-w, -w}}};
  Sections s;
  for (const auto& [section, from, to] : {std::tuple(low, 0.1, 2.0), std::tuple(high, 0.5, 10.0),
                                          std::tuple(Section{1.0, {w}, {-w}}, 0.1, 10.0),
                                          std::tuple(Section{w, {0.0}, {{-w, w}, {-w, -w}}}, 0.5, 2.0)}) {
    s.sections = {section};
    const double corner = RadPerSecond{std::abs(section.poles[0])}.hz().value;
    EXPECT_NEAR(judged_band(s).from.value / corner, from, 1e-12);
    EXPECT_NEAR(judged_band(s).to.value / corner, to, 1e-12);
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
