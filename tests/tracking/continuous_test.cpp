// Slow references: poles of isolating resistors (45 million rad/s), drives that turn twice in a moment or jump.
#include "tracking/continuous.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tracking/track.hpp"

namespace bodesmith::tracking {
namespace {

/// Two stages of gain -1 and a drawn circuit's poles and zeros.
Sections circuit(double first, double second) {
  Sections out;
  out.sections = {{-4.5454752e7 * first, {-206.61063}, {-4.54545454e7, -206.61157}},
                  {-6.6669e6 * second, {-277.766}, {-6.6666666e6, -277.7777}}};
  return out;
}

Plant nanopositioner() {
  Plant plant;
  plant.disturbance.ascending = {0.3546, -0.6433, 0.2887};
  plant.disturbance.descending = {-0.2398, 0.0838, 0.156};
  Section amplifier{Hertz{100e3}.rad_s().value, {}, {-Hertz{100e3}.rad_s().value}};
  plant.drive_path.sections = {amplifier};
  return plant;
}

TEST(TrackContinuous, SlowSinesThroughCircuitsAreWhatHarmonicsSay) {
  Options options;
  options.frequencies = {Hertz{1.0}, Hertz{2.0}, Hertz{5.0}, Hertz{20.0}};
  options.place = Options::Place::before_switch;
  options.reference = Reference::Shape::sine;
  options.relative_tolerance = 5e-7;
  std::vector<Design> designs;
  for (const GeneratorForm form : {GeneratorForm::one_pass(), GeneratorForm::self_fed()}) {
    for (const double second : {1.0, 0.83, 1.2})
      designs.push_back({std::to_string(designs.size()), ConstantGain{}, circuit(1.0, second), "", form});
  }
  const Report report = track(nanopositioner(), designs, options);
  ASSERT_EQ(report.cases.size(), 24u);
  for (const Case& one : report.cases) {
    ASSERT_TRUE(one.check.has_value());
    EXPECT_LT(one.check->difference_percent, 0.02) << one.design << " at " << one.frequency.value;
  }
}

// Fed by its own drive the generator leaves nothing of a slow reference, also where the drive jumps from branch to branch at a turn
// between two samples: a lag of microseconds is none at samples of milliseconds.
TEST(TrackHarmonics, NothingIsLeftOfSlowReferencesWhoseDriveJumps) {
  for (const auto shape :
       {Reference::Shape::two_tone, Reference::Shape::decaying_triangle, Reference::Shape::triangle}) {
    for (const double alpha : {1.0, 0.6}) {
      Options options;
      options.frequencies = {Hertz{0.1}, Hertz{0.5}, Hertz{1.0}};
      options.place = Options::Place::before_switch;
      options.reference = shape;
      options.alpha = alpha;
      options.time_domain = false;
      const Design design{"self-fed", ConstantGain{}, ConstantGain{}, "", GeneratorForm::self_fed()};
      for (const Case& one : track(nanopositioner(), {design}, options).cases)
        EXPECT_LT(one.rms_percent_without_lag, 0.01)
            << to_string(shape) << " " << alpha << " at " << one.frequency.value;
    }
  }
}

// Where the drive jumps the error stands for some microseconds: a mean over CVODE's own steps is what ever more samples of the
// closed form come to, one over samples hits or misses it.
TEST(TrackContinuous, ErrorsAreThoseThatHarmonicsConvergeTo) {
  for (const auto shape : {Reference::Shape::two_tone, Reference::Shape::decaying_triangle}) {
    Options options;
    options.frequencies = {Hertz{80.0}};
    options.place = Options::Place::before_switch;
    options.reference = shape;
    const Design design{"self-fed", ConstantGain{}, ConstantGain{}, "", GeneratorForm::self_fed()};
    const double in_time = track(nanopositioner(), {design}, options).cases.front().rms_percent;
    options.time_domain = false;
    options.harmonics = 65536;
    const double closed = track(nanopositioner(), {design}, options).cases.front().rms_percent;
    EXPECT_GT(closed, 0.1) << to_string(shape);
    EXPECT_NEAR(in_time, closed, 0.01 * closed) << to_string(shape);
  }
}

}  // namespace
}  // namespace bodesmith::tracking
