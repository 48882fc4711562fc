#include "fit/direct/direct_fit.hpp"
#include "fit/direct/curve_target.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

BodePoints curve(double from, double to, int count, const std::function<double(double)>& gain) {
  BodePoints out;
  for (const Hertz f : log_grid({Hertz{from}, Hertz{to}}, count))
    out.points.push_back({f, gain(f.value), std::nullopt, 1.0, 0});
  return out;
}

BodePoints five() {
  BodePoints out;
  const double f[] = {1, 10, 20, 60, 100};
  const double g[] = {1, 1.06, 1.1, 1.04, 1.17};
  for (int i = 0; i < 5; ++i) out.points.push_back({Hertz{f[i]}, g[i], std::nullopt, 1.0, 0});
  return out;
}

TEST(CurveTarget, JoinedPointsLieOnStraightLinesBetweenThem) {
  const CurveTarget points = make_curve_target(five(), false), all = joined(points, 0.01);
  ASSERT_EQ(all.frequency.size(), 5u + 4u * 7u);
  for (std::size_t i = 0; i < all.frequency.size(); ++i) {
    EXPECT_DOUBLE_EQ(all.weight[i], i < 5 ? points.weight[i] : 0.01);
    // The points first, then seven in each gap.
    const std::size_t gap = i < 5 ? std::min<std::size_t>(i, 3) : (i - 5) / 7;
    const double from = std::log(points.frequency[gap].value), to = std::log(points.frequency[gap + 1].value);
    const double t = (std::log(all.frequency[i].value) - from) / (to - from);
    EXPECT_NEAR(t, i < 5 ? static_cast<double>(i - gap) : ((i - 5) % 7 + 1) / 8.0, 1e-12);
    EXPECT_NEAR(all.log_gain[i], points.log_gain[gap] + t * (points.log_gain[gap + 1] - points.log_gain[gap]),
                1e-12);
  }
}

double a_weighting(double f) {
  const double s = f * f;
  return 1.2589 * 12194.0 * 12194.0 * s * s /
         ((s + 20.6 * 20.6) * std::sqrt((s + 107.7 * 107.7) * (s + 737.9 * 737.9)) * (s + 12194.0 * 12194.0));
}

double riaa(double f) {
  const double w = 2 * M_PI * f;
  return std::hypot(1, w * 318e-6) / std::hypot(1, w * 3180e-6) / std::hypot(1, w * 75e-6);
}

void expect_stable_minimum_phase(const Sections& sections) {
  for (const Section& section : sections.sections) {
    EXPECT_TRUE(section.is_stable());
    EXPECT_LE(section.zeros.size(), section.poles.size());
    for (const auto& zero : section.zeros) EXPECT_LE(zero.real(), 0.0);
  }
}

TEST(DirectFit, FivePointsOfTheFirstSeedWithThreeRealPoles) {
  const DirectFit fit = fit_directly(five(), {.order = 3, .real = true, .max_corner = Hertz{500.0}});
  EXPECT_LT(fit.max_db, 0.0016);
  EXPECT_EQ(fit.sections.pole_count(), 3);
  EXPECT_LE(fit.sections.corner_band().to.value, 500.0 * (1 + 1e-9));
  for (const Section& section : fit.sections.sections) {
    for (const auto& root : section.zeros) EXPECT_EQ(root.imag(), 0.0);
    for (const auto& root : section.poles) EXPECT_EQ(root.imag(), 0.0);
  }
  expect_stable_minimum_phase(fit.sections);
  // What the report says is what the sections do.
  for (const DirectFitPoint& point : fit.points) {
    EXPECT_NEAR(to_decibel(std::abs(fit.sections.response(point.frequency.rad_s()))), point.got_db, 1e-9);
  }
}

// Slope of -10 dB a decade over three decades: figures found independently.
TEST(DirectFit, PinkNoiseSlope) {
  const auto pink = curve(20, 20000, 200, [](double f) { return 1.0 / std::sqrt(f); });
  EXPECT_LT(fit_directly(pink, {.order = 4}).max_db, 0.0822);
  EXPECT_LT(fit_directly(pink, {.order = 6}).max_db, 0.0076);
}

TEST(DirectFit, CurvesThatAreRational) {
  const auto fit = fit_directly(curve(20, 20000, 150, riaa), {.order = 3, .real = true});
  EXPECT_LT(fit.max_db, 1e-4);
  // A pair that cancels is taken away.
  const auto high = fit_directly(curve(20, 20000, 150, riaa), {.order = 4});
  EXPECT_LT(high.max_db, 1e-4);
}

TEST(DirectFit, AWeighting) {
  const auto fit = fit_directly(curve(20, 20000, 150, a_weighting), {.order = 4});
  EXPECT_LT(fit.max_db, 0.11);
  expect_stable_minimum_phase(fit.sections);
}

TEST(DirectFit, ChebyshevFitAlternates) {
  // 2n + 1 free numbers: 2n + 2 alternating misses of one height for a slope, as in the theory of best
  // approximation.
  const auto fit = fit_directly(curve(1, 1000, 400, [](double f) { return std::pow(f, 0.3); }),
                                {.order = 3, .real = true});
  std::vector<double> heights;
  for (const DirectFitPoint& point : fit.points) {
    const double e = point.got_db - point.wanted_db;
    if (heights.empty() || (e > 0) != (heights.back() > 0))
      heights.push_back(e);
    else if (std::abs(e) > std::abs(heights.back()))
      heights.back() = e;
  }
  ASSERT_EQ(heights.size(), 8u);
  for (const double h : heights) EXPECT_NEAR(std::abs(h) / fit.max_db, 1.0, 0.01);
}

TEST(DirectFit, LeastSquaresHasTheSmallerRms) {
  const auto points = curve(20, 20000, 120, a_weighting);
  const auto chebyshev = fit_directly(points, {.order = 3, .real = true});
  const auto squares = fit_directly(points, {.order = 3, .real = true, .least_squares = true});
  EXPECT_LT(squares.rms_db, chebyshev.rms_db);
  EXPECT_GT(squares.max_db, chebyshev.max_db);
}

TEST(DirectFit, WeightsMatter) {
  auto points = curve(1, 1000, 60, [](double f) { return std::pow(f, 0.5); });
  for (BodePoint& point : points.points) point.weight = point.frequency.value < 30.0 ? 10.0 : 1.0;
  const auto fit = fit_directly(points, {.order = 2, .real = true});
  double low = 0.0;
  double high = 0.0;
  for (const DirectFitPoint& point : fit.points) {
    double& side = point.frequency.value < 30.0 ? low : high;
    side = std::max(side, std::abs(point.got_db - point.wanted_db));
  }
  EXPECT_NEAR(high / low, 10.0, 0.5);
}

TEST(DirectFit, RelativeDegreeAndCap) {
  const auto points = curve(1, 100, 60, [](double f) { return 1.0 / (1.0 + f * f / 400.0); });
  const auto fit = fit_directly(points, {.order = 3, .relative_degree = 2, .real = true});
  size_t zeros = 0;
  for (const Section& section : fit.sections.sections) zeros += section.zeros.size();
  EXPECT_EQ(static_cast<int>(zeros), fit.sections.pole_count() - 2);
  EXPECT_LT(fit.max_db, 1e-3);
}

TEST(DirectFit, MasksAreKept) {
  const auto points = curve(1, 1000, 60, [](double f) { return f < 30 ? 1.0 : 2.0; });
  BodePoints upper;
  upper.points = {{Hertz{1.0}, 1.02, std::nullopt, 1.0, 0}, {Hertz{20.0}, 1.02, std::nullopt, 1.0, 0}};
  const auto free = fit_directly(points, {.order = 3, .real = false});
  const auto masked = fit_directly(points, {.order = 3, .real = false, .upper = upper});
  const auto highest = [&](const DirectFit& fit) {
    double gain = 0.0;
    for (const Hertz f : log_grid({Hertz{1.0}, Hertz{20.0}}, 200))
      gain = std::max(gain, std::abs(fit.sections.response(f.rad_s())));
    return gain;
  };
  EXPECT_GT(highest(free), 1.03);
  EXPECT_LT(highest(masked), 1.0205);
  EXPECT_LT(masked.mask_violation_db, 1e-3);
}

TEST(DirectFit, ComplexData) {
  // Magnitude and phase of a known lead: both are met.
  BodePoints points;
  for (const Hertz f : log_grid({Hertz{1.0}, Hertz{1e4}}, 50)) {
    const std::complex<double> s(0.0, f.value);
    const auto h = 3.0 * (s + 20.0) * (s + 900.0) / ((s + 100.0) * (s + 4000.0));
    points.points.push_back({f, std::abs(h), to_degrees(std::arg(h)), 1.0, 0});
  }
  const auto fit = fit_directly(points, {.order = 2, .use_phase = true});
  EXPECT_LT(fit.max_db, 1e-4);
  EXPECT_LT(fit.max_phase_deg, 1e-3);
  EXPECT_EQ(fit.sections.error->max_phase_deg, fit.max_phase_deg);
  // A fit of magnitudes says nothing of phases.
  EXPECT_FALSE(fit_directly(points, {.order = 2}).sections.error->max_phase_deg);
  points.points[3].phase_deg.reset();
  EXPECT_THROW(fit_directly(points, {.order = 2, .use_phase = true}), InputError);
}

TEST(DirectFit, ThousandsOfRows) {
  const auto fit = fit_directly(curve(20, 20000, 4000, a_weighting), {.order = 4, .starts = 4});
  EXPECT_LT(fit.max_db, 0.12);
  EXPECT_EQ(fit.points.size(), 4000u);
}

TEST(DirectFit, SameSeedSameBytesAndRefusals) {
  const auto points = five();
  const DirectFitOptions options{.order = 2, .seed = 5};
  EXPECT_EQ(to_text(fit_directly(points, options).sections.to_json()),
            to_text(fit_directly(points, options).sections.to_json()));
  EXPECT_THROW(fit_directly(points, {.order = 0}), InputError);
  EXPECT_THROW(fit_directly(points, {.order = 13}), InputError);
  EXPECT_THROW(fit_directly(points, {.order = 2, .relative_degree = 3}), InputError);
  // One point: a gain.
  BodePoints one;
  one.points = {{Hertz{5.0}, 3.0, std::nullopt, 1.0, 0}};
  EXPECT_LT(fit_directly(one, {.order = 1}).max_db, 1e-9);
}

// A curve that falls to the end is fitted without zeros at a thousand times its highest frequency.
TEST(DirectFit, ZerosFarAboveAreLeftOutAndFarBelowStandAtZero) {
  const auto one = fit_directly(
      curve(10, 30000, 9, [](double f) { return 1.0 / std::hypot(1.0, f / 1000.0); }), {.order = 1});
  EXPECT_EQ(one.distant_zeros, 1);
  EXPECT_TRUE(one.sections.sections.at(0).zeros.empty());
  EXPECT_LT(one.max_db, 1e-4);
  EXPECT_NEAR(std::abs(one.sections.response(Hertz{1e6}.rad_s())), 1e-3, 1e-6);
  // One that falls to the beginning has its zero at 0 Hz.
  const auto high =
      fit_directly(curve(10, 30000, 9, [](double f) { return f / std::hypot(1000.0, f); }), {.order = 1});
  EXPECT_EQ(high.zeros_at_origin, 1);
  ASSERT_EQ(high.sections.sections.at(0).zeros.size(), 1u);
  EXPECT_EQ(high.sections.sections[0].zeros[0], std::complex<double>(0.0));
  EXPECT_LT(high.max_db, 1e-4);
  EXPECT_NEAR(std::abs(high.sections.response(Hertz{1.0}.rad_s())), 1e-3, 1e-6);
  // One that levels off keeps its zero.
  const auto shelf = fit_directly(
      curve(10, 30000, 9, [](double f) { return std::hypot(1.0, f / 2e5) / std::hypot(1.0, f / 1000.0); }),
      {.order = 1});
  EXPECT_EQ(shelf.distant_zeros, 0);
  ASSERT_EQ(shelf.sections.sections.at(0).zeros.size(), 1u);
  EXPECT_NEAR(shelf.sections.sections[0].zeros[0].real() / (-2e5 * 2.0 * std::numbers::pi), 1.0, 0.02);
}

TEST(DirectFit, NoFiniteCandidateIsRefused) {
  BodePoints points = five();
  for (BodePoint& point : points.points) point.weight = 1e300;
  EXPECT_THROW(fit_directly(points, {.order = 2}), DesignError);
}

}  // namespace

namespace {

/// A wavy slope that no fit of low order meets, so that nothing is proven and all starts would be followed.
BodePoints wavy_points() {
  BodePoints points;
  for (int i = 0; i < 60; ++i) {
    const double f = 10.0 * std::pow(1000.0, i / 59.0);
    points.points.push_back({Hertz{f}, (1.0 + 0.1 * std::sin(2.3 * i)) / std::sqrt(f), std::nullopt, 1.0, 0});
  }
  return points;
}

TEST(DirectFitDeadline, KeepsTheBestSoFarAndNamesWhatWasLeft) {
  DirectFitOptions options{.order = 3};
  options.least_squares = true;
  const DirectFit whole = fit_directly(wavy_points(), options);
  EXPECT_TRUE(whole.not_tried.empty());
  options.deadline = Deadline(1e-9);
  const DirectFit hurried = fit_directly(wavy_points(), options);
  EXPECT_FALSE(hurried.not_tried.empty());
  EXPECT_TRUE(std::isfinite(hurried.max_db));
  EXPECT_LT(hurried.rms_db, 3.0);
  for (const Section& section : hurried.sections.sections)
    for (const auto& pole : section.poles) EXPECT_LT(pole.real(), 0.0);
}

TEST(DirectFitDeadline, EndsTheSearchForAnOrderToo) {
  DirectFitOptions options;
  options.deadline = Deadline(1e-9);
  const DirectFit fit = fit_directly_within(wavy_points(), options, 1e-6, 1, 12);
  ASSERT_FALSE(fit.not_tried.empty());
  EXPECT_EQ(fit.not_tried.back(), "orders above 1");
}

TEST(Deadline, NeverPassesUnlessItIsSet) {
  EXPECT_FALSE(Deadline().passed());
  EXPECT_TRUE(Deadline(0.0).passed());
  EXPECT_FALSE(Deadline(1e300).passed());
}

}  // namespace

}  // namespace bodesmith
