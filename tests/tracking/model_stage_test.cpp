// The forms of the generator and the ways to follow the rate, on a stage that reads its drive: the figures of
// facts/tracking, an independent evaluation step by step, and CVODE against the harmonic computation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/model_type.hpp"
#include "tracking/model_stage.hpp"
#include "tracking/track.hpp"

namespace bodesmith::tracking {
namespace {

using Shape = Reference::Shape;

Disturbance rated_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  for (const double f : {1.0, 10.0, 20.0, 60.0, 100.0}) d.rate.frequency.push_back(Hertz{f});
  d.rate.ascending = std::vector<double>(5, 1.0);
  d.rate.descending = {1.0, 1.06, 1.1, 1.04, 1.17};
  return d;
}

ScheduledGain descending_table() {
  return {rated_disturbance().rate.frequency, {1.0, 1.06, 1.1, 1.04, 1.17}};
}

Sections two_poles() {
  Sections out;
  out.sections = {Section::pole_zero(1.02, Hertz{8}.rad_s(), Hertz{9}.rad_s()),
                  Section::pole_zero(1.0, Hertz{70}.rad_s(), Hertz{90}.rad_s())};
  return out;
}

Options tracked_at(std::vector<double> hz) {
  Options out;
  for (const double f : hz) out.frequencies.push_back(Hertz{f});
  out.place = Options::Place::before_switch;
  return out;
}

TEST(Generator, EachPassMoreLeavesLess) {
  Plant plant;
  plant.disturbance = rated_disturbance();
  plant.disturbance.rate = {};
  std::vector<Design> designs = {{"none", Uncompensated{}, Uncompensated{}, ""}};
  for (const int passes : {1, 2, 3, 0}) {
    const GeneratorForm form{passes};
    designs.push_back({std::to_string(passes), ConstantGain{}, ConstantGain{}, "", form});
  }
  const Report report = track(plant, designs, tracked_at({1.0}));
  const double wanted[] = {4.98, 0.616, 0.131, 0.034, 0.0};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(report.cases[i].rms_percent, wanted[i], i == 0 ? 0.005 : 0.0006) << report.cases[i].design;
    EXPECT_TRUE(report.cases[i].check.has_value());
  }
}

TEST(Generator, TheSlopeOfTheReferenceSetsTheGain) {
  // Facts: .003, .004, .003, .030, .063 % with a differentiator of .1 ms, gains straight over the frequency.
  Plant plant;
  plant.disturbance = rated_disturbance();
  const SlopeGain measured{descending_table(), 1e-4, 0.0};
  const Report report = track(plant, {{"slope", ConstantGain{}, measured, "", GeneratorForm::self_fed()}},
                              tracked_at({1, 10, 20, 60, 100}));
  const double at_most[] = {0.005, 0.006, 0.006, 0.04, 0.07};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_LT(report.cases[i].rms_percent, at_most[i]) << i;
  EXPECT_GT(report.cases[4].rms_percent, 0.01);
}

TEST(Generator, ASineNeedsTheSlopeSmoothed) {
  Plant plant;
  plant.disturbance = rated_disturbance();
  const auto design = [](const char* name, double smoothing) {
    return Design{name, ConstantGain{}, SlopeGain{descending_table(), 1e-4, smoothing}, "",
                  GeneratorForm::self_fed()};
  };
  Options options = tracked_at({20});
  options.reference = Shape::sine;
  const Report report = track(plant, {design("bare", 0.0), design("smoothed", 2.0)}, options);
  EXPECT_GT(report.cases[0].rms_percent, 0.05);
  EXPECT_LT(report.cases[1].rms_percent, 0.01);
}

TEST(Generator, FilterAndScheduleTogetherDoWhatTheScheduleAloneDoes) {
  const Disturbance d = rated_disturbance();
  const ScheduledGain rest = rest_of(two_poles(), d, Disturbance::Branch::descending);
  ASSERT_EQ(rest.gain.size(), 5u);
  for (const double g : rest.gain) EXPECT_LT(std::abs(g), 0.2);
  Plant plant;
  plant.disturbance = d;
  const Report report =
      track(plant,
            {{"filter", ConstantGain{}, two_poles(), "", GeneratorForm::self_fed()},
             {"sum", ConstantGain{}, FilterAndSchedule{two_poles(), rest}, "", GeneratorForm::self_fed()}},
            tracked_at({1, 20, 100}));
  for (const double f : {1.0, 20.0, 100.0})
    EXPECT_LE(report.find(Hertz{f}, "sum")->rms_percent,
              1.001 * report.find(Hertz{f}, "filter")->rms_percent);
}

/// The loop with the filter in its falling branch, by the trapezoidal rule from rest until it repeats, with nothing
/// of the program's but the polynomials; rms error of a stage that reads its drive, percent.
double stepped_by_hand(double f) {
  const Disturbance d = rated_disturbance();
  const double k = d.rate_gain(Disturbance::Branch::descending, Hertz{f});
  constexpr int kSteps = 4000;
  const double h = 1.0 / (f * kSteps);
  // (s/z + 1)/(s/p + 1) = p/z + (1 - p/z)/(s/p + 1), twice.
  const double pi = std::acos(-1.0);
  const double z[] = {16 * pi, 140 * pi};
  const double p[] = {18 * pi, 180 * pi};
  double state[] = {0.0, 0.0};
  double last_input[] = {0.0, 0.0};
  double sum = 0.0;
  double low = 1.0;
  double high = 0.0;
  const int periods = 3 + static_cast<int>(f / 2.0);
  for (int i = 0; i < periods * kSteps; ++i) {
    const double theta = static_cast<double>(i % kSteps) / kSteps;
    const bool rising = theta < 0.5;
    const double r = rising ? 2.0 * theta : 2.0 - 2.0 * theta;
    double v = r;
    double next[2] = {};
    double input[2] = {};
    for (int round = 0; round < 60; ++round) {
      double w = 1.02 * d.value(Disturbance::Branch::descending, v);
      for (int s = 0; s < 2; ++s) {
        input[s] = w;
        const double a = 0.5 * h * p[s];
        next[s] = ((1 - a) * state[s] + a * (last_input[s] + w)) / (1 + a);
        w = p[s] / z[s] * w + (1 - p[s] / z[s]) * next[s];
      }
      v = r - (rising ? d.value(Disturbance::Branch::ascending, v) : w);
    }
    std::copy_n(next, 2, state);
    std::copy_n(input, 2, last_input);
    if (i < (periods - 1) * kSteps) continue;
    const double y = v + (rising ? d.value(Disturbance::Branch::ascending, v)
                                 : k * d.value(Disturbance::Branch::descending, v));
    low = std::min(low, y);
    high = std::max(high, y);
    sum += (y - r) * (y - r);
  }
  return 100.0 * std::sqrt(sum / kSteps) / (high - low);
}

TEST(Generator, ALoopWithAFilterInItIsWhatSteppingByHandFinds) {
  Plant plant;
  plant.disturbance = rated_disturbance();
  const Report report = track(plant, {{"loop", ConstantGain{}, two_poles(), "", GeneratorForm::self_fed()}},
                              tracked_at({5, 100}));
  for (const Case& c : report.cases) {
    EXPECT_TRUE(c.check.has_value());
    EXPECT_NEAR(c.rms_percent, stepped_by_hand(c.frequency.value), 1e-3) << c.frequency.value;
    EXPECT_NEAR(c.check->rms_percent, c.rms_percent, 1e-3);
  }
}

TEST(Generator, CvodeAgreesOnEveryReferenceFormAndRate) {
  Plant plant;
  plant.disturbance = rated_disturbance();
  plant.drive_path.sections = {Section{Hertz{1e5}.rad_s().value, {}, {-Hertz{1e5}.rad_s().value}}};
  const SlopeGain slope{descending_table(), 1e-4, 5e-3};
  for (const Shape shape : {Shape::triangle, Shape::sine, Shape::two_tone, Shape::decaying_triangle}) {
    std::vector<Design> designs;
    for (const int passes : {1, 2, 0}) {
      const GeneratorForm form{passes};
      designs.push_back({"filter" + std::to_string(passes), ConstantGain{}, two_poles(), "", form});
      designs.push_back({"slope" + std::to_string(passes), ConstantGain{}, slope, "", form});
    }
    Options options = tracked_at({60});
    options.reference = shape;
    for (const double alpha : {1.0, 0.25}) {
      options.alpha = alpha;
      const Report report = track(plant, designs, options);
      for (const Case& c : report.cases) {
        ASSERT_TRUE(c.check.has_value());
        // At inner turning points the drive jumps from branch to branch within the amplifier's 2 us, about one
        // sample of 8192: how much of that a sample catches is chance.
        const double allowed = shape == Shape::two_tone ? 1.3 : shape == Shape::triangle ? 0.1 : 0.3;
        EXPECT_LT(c.check->difference_percent, allowed) << c.design << " " << to_string(shape) << alpha;
        EXPECT_NEAR(c.rms_percent, c.check->rms_percent, 0.3 * allowed)
            << c.design << " " << to_string(shape);
      }
    }
  }
}

TEST(Generator, WhatAStageWouldShowThatReadTheReferenceComesWithIt) {
  Plant plant;
  plant.disturbance = rated_disturbance();
  const std::vector<Design> designs = {{"once", ConstantGain{}, two_poles(), ""},
                                       {"loop", ConstantGain{}, two_poles(), "", GeneratorForm::self_fed()}};
  Options options = tracked_at({1.0, 60.0});
  options.also_on_reference = true;
  const Report both = track(plant, designs, options);
  options.also_on_reference = false;
  options.argument = Options::Argument::reference;
  options.time_domain = false;
  const Report alone = track(plant, designs, options);
  for (std::size_t i = 0; i < both.cases.size(); ++i) {
    EXPECT_EQ(both.cases[i].on_reference_percent.value(), alone.cases[i].rms_percent) << both.cases[i].design;
    EXPECT_FALSE(alone.cases[i].on_reference_percent.has_value());
  }
}

TEST(Generator, ALoopThatCannotSettleIsRefused) {
  Plant plant;
  plant.disturbance = rated_disturbance();
  const Design wild{"wild", ConstantGain{3.0}, ConstantGain{3.0}, "", GeneratorForm::self_fed()};
  EXPECT_THROW(track(plant, {wild}, tracked_at({1})), DesignError);
}

TEST(Generator, AStageOfAnotherFamilyAnswersTheDrive) {
  Plant plant;
  plant.disturbance = rated_disturbance();
  plant.disturbance.rate = {};
  IdentifiedStage::Options options;
  options.samples = 40;
  options.identify.size = 20;
  const auto stage = std::make_shared<IdentifiedStage>(hysteresis::model_type_registry().get("preisach"),
                                                       plant.disturbance, StagePaths{}, options);
  plant.stage = stage;
  const Report report = track(plant,
                              {{"one", ConstantGain{}, ConstantGain{}, ""},
                               {"self", ConstantGain{}, ConstantGain{}, "", GeneratorForm::self_fed()}},
                              tracked_at({1}));
  EXPECT_NEAR(report.cases[0].rms_percent, 0.616, 0.05);
  EXPECT_NEAR(report.cases[1].rms_percent, stage->fit_percent(Hertz{1}), 0.02);
}

}  // namespace
}  // namespace bodesmith::tracking
