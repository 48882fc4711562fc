// Two independent computations of what a compensator's waveform is worth, harmonic sums with exact Fourier
// coefficients (fit) and sampled periods with CVODE (tracking), for a compensator before and behind the
// branch switch.
#include <gtest/gtest.h>

#include "fit/waveform/waveform_error.hpp"
#include "tracking/track.hpp"

namespace bodesmith {
namespace {

using tracking::ConstantGain;
using Place = tracking::Options::Place;

Disturbance seed(bool both_branches) {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  d.rate.frequency = {Hertz{1}, Hertz{10}, Hertz{100}};
  d.rate.descending = {1.0, 1.06, 1.17};
  d.rate.ascending = both_branches ? d.rate.descending : std::vector<double>{1.0, 1.0, 1.0};
  return d;
}

Sections lead() {
  Sections g;
  g.sections = {Section::pole_zero(1.02, Hertz{8}.rad_s(), Hertz{9}.rad_s()),
                Section::pole_zero(1.0, Hertz{70}.rad_s(), Hertz{90}.rad_s())};
  return g;
}

void compare(bool both_branches, Place place, DrivenPath path) {
  const Disturbance disturbance = seed(both_branches);
  const Sections g = lead();
  tracking::Plant plant;
  plant.disturbance = disturbance;
  tracking::Design design{"lead", ConstantGain{}, g, ""};
  if (both_branches) design.ascending = g;
  tracking::Options options;
  options.frequencies = disturbance.rate.frequency;
  options.place = place;
  options.argument = tracking::Options::Argument::reference;  // the formula's own evaluation
  const auto tracked = tracking::track(plant, {design}, options);
  WaveformErrorOptions error_options;
  error_options.path = path;
  const WaveformError error = waveform_error([&](RadPerSecond w) { return g.response(w); }, disturbance,
                                             disturbance.rate.frequency, error_options);
  for (size_t i = 0; i < error.points.size(); ++i) {
    const auto& found = tracked.cases[i];
    // The stage of this plant is the identity: the displacement's error is the waveform's, but eq. 8 divides
    // by the range of y, which the error itself widens by a few percent.
    EXPECT_TRUE(found.check.has_value());
    EXPECT_NEAR(found.rms_percent, error.points[i].rms_percent, 0.03 * error.points[i].rms_percent + 1e-3);
  }
}

TEST(CompensatorPlace, BehindTheSwitchOnTheWholeWaveform) {
  compare(true, Place::behind_switch, DrivenPath::whole);
}

TEST(CompensatorPlace, BeforeTheSwitchInItsBranchsPath) {
  compare(false, Place::before_switch, DrivenPath::descending);
}

TEST(CompensatorPlace, ThePlaceMatters) {
  const Disturbance disturbance = seed(false);
  tracking::Plant plant;
  plant.disturbance = disturbance;
  tracking::Options options;
  options.frequencies = {Hertz{100}};
  const tracking::Design design{"lead", ConstantGain{}, lead(), ""};
  const double behind = tracking::track(plant, {design}, options).cases[0].rms_percent;
  options.place = Place::before_switch;
  const double before = tracking::track(plant, {design}, options).cases[0].rms_percent;
  EXPECT_GT(std::abs(behind - before), 0.01);
}

}  // namespace
}  // namespace bodesmith
