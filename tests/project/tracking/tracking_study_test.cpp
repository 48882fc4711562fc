// The first seed's stage, followed through every design choice below and above what its gains are known for.
#include "project/tracking/follow_designs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "project/make_design.hpp"

namespace bodesmith::project {
namespace {

Project seed_project(std::vector<Hertz> frequencies) {
  Provenance from;
  const std::filesystem::path root = BODESMITH_SOURCE_DIR;
  Project project = ProjectSource::read(root / "examples/nanopositioner/seed.toml").project(from);
  project.track.frequency = std::move(frequencies);
  project.fpaa->clock = Hertz{2000};
  return project;
}

TEST(Design, ThePapersMeetsItsLimitOnTheBoardAtClocksThatAreFound) {
  Project project = seed_project({Hertz{1}, Hertz{100}});
  project.fpaa->clock.reset();
  const fpaa::Plan plan = *make_design(project).plan;
  EXPECT_LE(plan.error_with_delays.max_complex_percent, *project.limits.fpaa_percent);
  EXPECT_LE(plan.total->p95_percent, 0.5);
  EXPECT_GE(plan.total->at_input_v, 1.5);
}

// A triangle's slope is its frequency at once; of anything else it is a mean over three periods of the slowest.
TEST(TrackedCandidates, TheSlopeIsSmoothedWhereItIsNotConstant) {
  Project project = seed_project({Hertz{50}, Hertz{10}});
  const Design design = make_design(project);
  const auto smoothing = [&] {
    const auto all = tracked_candidates(project, design);
    const auto found = std::ranges::find(all, std::string(tracked::self_fed_slope), &TrackedCandidate::key);
    return std::get<tracking::SlopeGain>(found->design.descending).smoothing_s;
  };
  EXPECT_EQ(smoothing(), 0.0);
  project.track.waveforms = {tracking::Reference::Shape::sine};
  EXPECT_NEAR(smoothing(), 0.3, 1e-12);
}

TrackingStudy study_tracking(const Project& project, const Design& design) {
  const std::vector<TrackedCandidate> candidates = tracked_candidates(project, design);
  return tracking_study(project, design, make_budget(project, design), candidates,
                        follow_designs(project, candidates), {}, {});
}

bool says(const TrackingStudy& study, const std::string& words) {
  return std::any_of(study.findings.begin(), study.findings.end(),
                     [&](const std::string& f) { return f.find(words) != std::string::npos; });
}

TEST(TrackingStudy, PureLagIsToldFromTheRest) {
  const Project project = seed_project({Hertz{10}, Hertz{1000}, Hertz{5000}});
  const Design design = make_design(project);
  const TrackingStudy study = study_tracking(project, design);
  const TrackedDesign* scheduled = study.find(tracked::self_fed_scheduled);
  ASSERT_NE(scheduled, nullptr);
  // Group delay of amplifier, damping compensator and resonance at low frequency: 1/w_a + 1.917e5/1.436e11 -
  // 9.854e4/1.67e11 + 2 0.1206/w_r.
  const double lag = 1.0 / Hertz{100e3}.rad_s().value + 1.917e5 / 1.436e11 - 9.854e4 / 1.67e11 +
                     2.0 * 0.1206 / Hertz{65.1e3}.rad_s().value;
  for (size_t i = 1; i < 3; ++i) {
    EXPECT_NEAR(scheduled->at[i].lag_s, lag, 0.05 * lag);
    // A triangle that is late by tau is off by 2 f tau nearly all the time.
    EXPECT_NEAR(scheduled->at[i].rms_percent, 100.0 * 2.0 * study.frequency[i].value * lag,
                0.1 * scheduled->at[i].rms_percent);
    EXPECT_LT(scheduled->at[i].rms_percent_without_lag, 0.2 * scheduled->at[i].rms_percent);
  }
  for (const TrackedDesign& d : study.designs) {
    ASSERT_EQ(d.at.size(), 3u);
    for (const tracking::TrackingError& one : d.at)
      EXPECT_LE(one.rms_percent_without_lag, 1.0001 * one.rms_percent) << d.name;
  }
  EXPECT_NE(tracking_csv(study).find("circuit_without_lag_percent"), std::string::npos);
  EXPECT_TRUE(says(study, "The disturbance's gains are known up to 100 Hz; at 1000 and 5000 Hz"));
  // Stages of one phase follow their input and each other: a clock of 2 kHz is not what costs most.
  EXPECT_FALSE(says(study, "Most accuracy is lost from 'FPAA, capacitors only' to 'FPAA with sample, hold"));
}

TEST(TrackingStudy, MagnitudeOnlyIsSaidToBeWorseOnlyWhereItIs) {
  const Project project = seed_project({Hertz{60}, Hertz{100}});
  const Design design = make_design(project);
  const TrackingStudy study = study_tracking(project, design);
  EXPECT_GT(study.find(tracked::cascade)->at[1].rms_percent_without_lag,
            study.find(tracked::polynomial)->at[1].rms_percent_without_lag);
  EXPECT_TRUE(says(study, "worse than the constant polynomial at 60 and 100 Hz"));
  EXPECT_FALSE(says(study, "gains are known up to"));
  EXPECT_LT(study.max_cross_check_percent, 0.1);
}

}  // namespace
}  // namespace bodesmith::project
