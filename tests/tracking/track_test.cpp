#include "tracking/track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "approximate/approximate.hpp"
#include "base/error.hpp"
#include "lti/cascade.hpp"
#include "lti/section_making.hpp"
#include "tracking/model_stage.hpp"

namespace bodesmith::tracking {
namespace {

/// Disturbance paper, eq. 20, the damping compensator of its nanopositioner's mode at 65.1 kHz:
///   0.86 (s^2 + 9.854e4 s + 1.67e11)/(s^2 + 1.917e5 s + 1.436e11)
Sections published_damping_compensator() {
  // Roots of s^2 + linear s + constant.
  const auto roots = [](double linear, double constant) {
    const double im = std::sqrt(constant - 0.25 * linear * linear);
    return std::vector<std::complex<double>>{{-0.5 * linear, im}, {-0.5 * linear, -im}};
  };
  return Sections{1.0, {Section{0.86, roots(9.854e4, 1.67e11), roots(1.917e5, 1.436e11)}}, std::nullopt};
}

constexpr double kPi = std::numbers::pi;

/// First seed: full-stroke polynomials of both branches and the gains of Table I with the added 10 Hz point.
Disturbance seed_disturbance(bool both_branches) {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  for (const double f : {1.0, 10.0, 20.0, 60.0, 100.0}) d.rate.frequency.push_back(Hertz{f});
  d.rate.descending = {1.0, 1.06, 1.1, 1.04, 1.17};
  d.rate.ascending = both_branches ? d.rate.descending : std::vector<double>(5, 1.0);
  return d;
}

/// Eq. 18 solved for exactly these gains (facts: not the orders the paper prints).
Cascade seed_cascade() {
  const double f[] = {1.0, 10.0, 20.0, 60.0, 100.0};
  const double beta[] = {-0.0428, 1.0245, -1.2113, 2.2908};
  Cascade c;
  for (int i = 0; i < 4; ++i) c.terms.push_back({1.0 / (2.0 * kPi * f[i]), f[i] / f[i + 1], beta[i]});
  return c;
}

ResponseCompensator ideal(const Cascade& cascade) {
  ResponseCompensator r;
  r.response = [cascade](RadPerSecond w) { return cascade.response(w); };
  ApproximationOptions options;
  options.method = "pade";
  options.order = 8;
  const auto got = approximate_cascade(cascade, options);
  r.approximation = got.sections;
  return r;
}

Options at(std::vector<double> hz) {
  Options o;
  for (const double f : hz) o.frequencies.push_back(Hertz{f});
  return o;
}

TEST(Tracking, MagnitudeOnlyCompensationIsWorseThanNoneAsTheFactsSay) {
  // Measured for this project by other means: 1.40 % of range at 100 Hz through the cascade, 0.85 % without
  // rate compensation (the same gains on both branches).
  Plant plant;
  plant.disturbance = seed_disturbance(true);
  const auto cascade = ideal(seed_cascade());
  const std::vector<Design> designs = {{"none", Uncompensated{}, Uncompensated{}, ""},
                                       {"constant", ConstantGain{}, ConstantGain{}, ""},
                                       {"ideal", cascade, cascade, ""}};
  auto options = at({100.0});
  options.argument = Options::Argument::reference;
  const auto report = track(plant, designs, options);
  EXPECT_NEAR(report.find(Hertz{100.0}, "constant")->rms_percent, 0.85, 0.01);
  EXPECT_GT(report.find(Hertz{100.0}, "ideal")->rms_percent, 1.3);
  for (const auto& c : report.cases) {
    EXPECT_TRUE(c.check.has_value()) << c.design;
    EXPECT_LT(c.check->difference_percent, 1e-4) << c.design;
    EXPECT_NEAR(c.check->rms_percent, c.rms_percent, 1e-4) << c.design;
  }
  EXPECT_GT(report.find(Hertz{100.0}, "ideal")->rms_percent_without_lag,
            report.find(Hertz{100.0}, "constant")->rms_percent_without_lag);
}

/// Everything of the seed's stage: amplifier, damping compensator (eq. 20), mode at 65.1 kHz; rate gains on
/// one branch.
Plant seed_plant() {
  Plant plant;
  plant.disturbance = seed_disturbance(false);
  plant.stroke = 6.92;
  plant.drive_path = lowpass_path(Hertz{1e5});
  plant.stage_path = in_series({published_damping_compensator(), resonance_path(Hertz{65.1e3}, 0.1206)});
  return plant;
}

TEST(Tracking, EveryDesignAgreesWithTheHarmonicComputation) {
  const auto cascade = ideal(seed_cascade());
  const std::vector<Design> designs = {{"none", Uncompensated{}, Uncompensated{}, ""},
                                       {"constant", ConstantGain{}, ConstantGain{}, ""},
                                       {"ideal", ConstantGain{}, cascade, ""},
                                       {"sections", ConstantGain{}, *cascade.approximation, "ideal"}};
  for (const auto reference : {Reference::Shape::triangle, Reference::Shape::sine}) {
    for (const auto argument : {Options::Argument::reference, Options::Argument::drive}) {
      auto options = at({1, 20, 100, 5000});
      options.reference = reference;
      options.argument = argument;
      const auto report = track(seed_plant(), designs, options);
      for (const auto& c : report.cases) {
        EXPECT_TRUE(c.check.has_value());
        // The harmonic side finds extremes, and where the drive turns, only to a sample of 8192.
        const double allowed = argument == Options::Argument::reference ? 1e-3 : 1e-2;
        EXPECT_LT(c.check->difference_percent, allowed) << c.design << " at " << c.frequency.value;
        EXPECT_NEAR(c.rms_percent, c.check->rms_percent, allowed);
        ASSERT_EQ(c.displacement.size(), 400u);
        // The waveforms that are kept are the ones that were judged (400 samples of them), in the stage's unit.
        double squares = 0.0;
        for (std::size_t i = 0; i < 400; ++i) squares += std::pow(c.displacement[i] - c.reference[i], 2);
        EXPECT_NEAR(100.0 * std::sqrt(squares / 400.0) / (6.92 * c.range), c.rms_percent,
                    0.01 * c.rms_percent + allowed)
            << c.design << " at " << c.frequency.value;
        const auto [low, high] = std::ranges::minmax(c.reference);
        EXPECT_NEAR(high - low, 6.92, 1e-3);
      }
    }
  }
}

TEST(Tracking, AnIdealPlantAndAnIdealCompensatorLeaveNothing) {
  Plant plant;
  plant.disturbance = seed_disturbance(false);
  plant.disturbance.rate = {};
  // By the formulas; a stage that reads its drive needs a generator that does so too.
  auto options = at({3.0});
  for (const auto argument : {Options::Argument::reference, Options::Argument::drive}) {
    options.argument = argument;
    const auto form =
        argument == Options::Argument::drive ? GeneratorForm::self_fed() : GeneratorForm::one_pass();
    const auto report = track(plant, {{"constant", ConstantGain{}, ConstantGain{}, "", form}}, options);
    EXPECT_LT(report.cases[0].rms_percent, 1e-10);
    EXPECT_NEAR(report.cases[0].lag_s, 0.0, 1e-9);
  }
}

TEST(Tracking, ThePureDelayOfAPathIsFoundAndRemoved) {
  // A lag of 50 us far above the reference is a delay.
  Plant plant;
  plant.disturbance.ascending = plant.disturbance.descending = {0.0, 0.0, 0.0};
  plant.drive_path = lowpass_path(RadPerSecond{1.0 / 50e-6}.hz());
  auto options = at({10.0});
  options.reference = Reference::Shape::sine;
  const auto report = track(plant, {{"none", Uncompensated{}, Uncompensated{}, ""}}, options);
  EXPECT_NEAR(report.cases[0].lag_s, 50e-6, 1e-9);
  // What is left is the lag's loss of amplitude, (w tau)^2/2 of 1/2.
  const double loss = 0.5 * std::pow(2.0 * kPi * 10.0 * 50e-6, 2);
  EXPECT_NEAR(report.cases[0].rms_percent_without_lag, 100.0 * loss * 0.5 / std::sqrt(2.0), 1e-6);
}

TEST(Tracking, AGainScheduledOnFrequencyLeavesOnlyItsTablesError) {
  Plant plant;
  plant.disturbance.ascending = {0.3546, -0.6433, 0.2887};
  plant.disturbance.descending = {-0.2398, 0.0838, 0.156};
  plant.disturbance.rate = {{Hertz{1}, Hertz{10}, Hertz{100}}, {1.0, 1.0, 1.0}, {1.0, 1.06, 1.17}};
  Options options;
  options.frequencies = {Hertz{1}, Hertz{10}, Hertz{31.6}, Hertz{100}};
  const ScheduledGain exact{plant.disturbance.rate.frequency, plant.disturbance.rate.descending};
  const ScheduledGain wrong{{Hertz{1}}, {1.0}};
  const auto report = track(plant,
                            {{"scheduled", ConstantGain{}, exact, "", GeneratorForm::self_fed()},
                             {"held", ConstantGain{}, wrong, ""},
                             {"constant", ConstantGain{}, ConstantGain{}, ""}},
                            options);
  for (const Hertz f : options.frequencies) {
    EXPECT_LT(report.find(f, "scheduled")->rms_percent, 1e-4) << f.value;
    EXPECT_DOUBLE_EQ(report.find(f, "held")->rms_percent, report.find(f, "constant")->rms_percent);
  }
  EXPECT_THROW(track(plant, {{"empty", ConstantGain{}, ScheduledGain{}, ""}}, options), InputError);
  // A loop that runs away beyond all numbers.
  const ConstantGain large{30.0};
  EXPECT_THROW(track(plant, {{"loop", large, large, "", GeneratorForm::self_fed()}}, options), DesignError);
}

}  // namespace
}  // namespace bodesmith::tracking
