// What a study says of figures that are given: which design stands for the run, what is found, by how much engines agree.
#include "project/tracking/follow_designs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "project/tracking/engines.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith::project {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::vector<Hertz> kTracked = {Hertz{10.0}, Hertz{100.0}, Hertz{40.0}};

Project nanopositioner() {
  Provenance from;
  Project out = ProjectSource::read(std::filesystem::path(BODESMITH_SOURCE_DIR) /
                                    "examples/nanopositioner/project.toml")
                    .project(from);
  out.track.frequency = kTracked;
  return out;
}

/// Designs by their keys with the error (lag removed) at each frequency; with it, its lag costs twice as much.
struct Figures {
  std::vector<TrackedCandidate> candidates;
  tracking::Report report;
  Budget budget;

  Figures& add(std::string_view key, std::vector<double> percent, bool built = false, int parts = 0,
               std::string made_from = {}, double lost = 0.0) {
    TrackedCandidate& one = candidates.emplace_back();
    one.key = key;
    one.built = built;
    one.parts = parts;
    one.design.name = "the " + std::string(key);
    one.design.made_from = std::move(made_from);
    for (std::size_t i = 0; i < percent.size(); ++i) {
      tracking::Case made;
      made.frequency = kTracked[i];
      made.design = one.design.name;
      made.rms_percent_without_lag = percent[i];
      made.rms_percent = 2.0 * percent[i];
      made.on_reference_percent = 0.5 * percent[i];
      made.lost_rms_percent = lost * (1.0 + 0.1 * static_cast<double>(i));
      made.check = tracking::Case::Check{2.0 * percent[i] + 0.25, 0.01 * percent[i]};
      made.time_s = {0.0, 1.0};
      made.reference = {0.0, 6.92e-6};
      made.displacement = {0.01 * 6.92e-6, 6.92e-6 * (1.0 - 0.01 * percent[i])};
      report.cases.push_back(std::move(made));
    }
    return *this;
  }
  TrackingStudy study(const Project& project, std::vector<TrackedElsewhere> elsewhere = {}) {
    budget.rows.resize(1);
    budget.rows[0].waveform.worst_percent = 7.25;
    budget.uncompensated.worst_percent = 6.25;
    budget.constant.worst_percent = 3.5;
    return tracking_study(project, {}, budget, candidates, report, {}, std::move(elsewhere));
  }
};

/// Of the sections 4 % less than the constant polynomial at 10 Hz, more elsewhere.
Figures usual() {
  Figures out;
  out.add(tracked::none, {9.0, 12.0, 10.0})
      .add(tracked::polynomial, {1.0, 3.0, 2.0}, true, 3)
      .add(tracked::cascade, {1.01, 3.5, 2.9})
      .add(tracked::sections, {0.9, 2.5, 1.9}, false, 0, "the cascade", 0.2)
      .add(tracked::circuit, {0.8, 2.4, 1.8}, true, 9, "the sections", 0.3)
      .add(tracked::self_fed_sections, {0.4, 1.0, 0.5})
      .add(tracked::self_fed_scheduled, {0.3, 0.5, 0.1});
  return out;
}

TEST(TrackingStudyOfFigures, WhatIsFoundIsWhatTheFiguresSay) {
  Project project = nanopositioner();
  Figures figures = usual();
  const TrackingStudy study = figures.study(project);
  EXPECT_EQ(study.find(tracked::circuit)->worst_without_lag_percent(), 2.4);
  EXPECT_EQ(study.find(tracked::circuit)->worst_percent(), 4.8);
  EXPECT_EQ(study.find(tracked::circuit)->each(&tracking::TrackingError::rms_percent),
            (std::vector<double>{1.6, 4.8, 3.6}));
  EXPECT_EQ(study.find("nothing"), nullptr);
  EXPECT_EQ(study.max_cross_check_percent, 0.12);
  // One period at the highest frequency, of the stroke.
  EXPECT_EQ(study.shown.frequency.value, 100.0);
  EXPECT_EQ(study.shown.reference, (std::vector<double>{0.0, 1.0}));
  ASSERT_EQ(study.shown.error_percent.size(), 7u);
  EXPECT_NEAR(study.shown.error_percent[0][0], 1.0, 1e-9);
  EXPECT_NEAR(study.shown.error_percent[0][1], -12.0, 1e-9);
  // The cascade is 1 % worse at 10 Hz, which is not said, and 16 and 45 % elsewhere.
  EXPECT_THAT(study.findings,
              Contains(HasSubstr(
                  "constant polynomial at 100 and 40 Hz (2.9 % of range rms instead of 2 % at 40 Hz")));
  EXPECT_THAT(study.findings, Not(Contains(HasSubstr("Over all tracked frequencies"))));
  EXPECT_THAT(
      study.findings,
      Contains(HasSubstr(
          "leaves 2 % of range rms at 10 Hz, where an evaluation of the stage on the reference says 0.5 %")));
  EXPECT_THAT(study.findings, Contains(HasSubstr("leaves 0.6 % there")));
  EXPECT_THAT(
      study.findings,
      Contains(HasSubstr(
          "does better than the linear filter: 0.5 % of range rms at worst (pure delay removed), against 1 %")));
  EXPECT_THAT(
      study.findings,
      Contains(HasSubstr(
          "from 'the sections' to 'the circuit': the compensating waveform changes by 0.36 % of range rms at 40 Hz")));
  EXPECT_THAT(study.findings, Not(Contains(HasSubstr("worse than without compensation"))));
  EXPECT_THAT(study.findings, Not(Contains(HasSubstr("As built ('"))));
  figures.budget.magnitude_only_is_worse = true;
  EXPECT_THAT(
      figures.study(project).findings,
      Contains(HasSubstr(
          "waveform is 7.25 % of range at worst; it is 6.25 % without any rate compensation and 3.5 % with")));
  // Twice as good is said, more than half as bad is not; no schedule, nothing to say.
  Figures near;
  near.add(tracked::none, {9, 9, 9})
      .add(tracked::cascade, {1, 1, 1})
      .add(tracked::polynomial, {1, 1, 1})
      .add(tracked::self_fed_sections, {1, 1, 1});
  EXPECT_THAT(near.study(project).findings, Not(Contains(HasSubstr("better than the linear filter"))));
  near.add(tracked::self_fed_scheduled, {0.51, 0.51, 0.51});
  EXPECT_THAT(near.study(project).findings, Not(Contains(HasSubstr("better than the linear filter"))));
  EXPECT_THAT(near.study(project).findings, Not(Contains(HasSubstr("Most accuracy is lost"))));
}

TEST(TrackingStudyOfFigures, WhatStandsForTheRun) {
  Project project = nanopositioner();
  project.choice = Project::Choice::tracking;
  EXPECT_EQ(usual().study(project).as_built, tracked::circuit);
  // Within a hundredth of one another the fewer parts count, beyond the lesser error.
  EXPECT_EQ(usual().add("controller_a", {2.39, 0, 0}, true, 8).study(project).as_built, "controller_a");
  EXPECT_EQ(usual().add("controller_a", {2.39, 0, 0}, true, 10).study(project).as_built, tracked::circuit);
  EXPECT_EQ(usual().add("controller_a", {2.42, 0, 0}, true, 8).study(project).as_built, "controller_a");
  EXPECT_EQ(usual().add("controller_a", {2.43, 0, 0}, true, 8).study(project).as_built, tracked::circuit);
  EXPECT_EQ(usual().add("controller_a", {2.3, 0, 0}, true, 10).study(project).as_built, "controller_a");
  EXPECT_EQ(usual().add("ideal", {0.1, 0.1, 0.1}).study(project).as_built, tracked::circuit);
  Figures ideal;
  ideal.add(tracked::none, {9, 9, 9})
      .add(tracked::cascade, {1, 1, 1})
      .add(tracked::polynomial, {1, 1, 1})
      .add(tracked::sections, {1, 1, 1});
  EXPECT_EQ(ideal.study(project).as_built, tracked::sections);
  // Where the project chose by something else, one pass through what is there.
  project.choice = Project::Choice::as_asked;
  EXPECT_EQ(ideal.study(project).as_built, tracked::sections);
  EXPECT_EQ(ideal.add(tracked::fpaa_with_holds, {5, 5, 5}, true).study(project).as_built,
            tracked::fpaa_with_holds);
  EXPECT_THAT(
      ideal.study(project).findings,
      Contains(HasSubstr(
          "As built ('the fpaa_with_holds') the stage tracks worse than with the constant polynomial at 10, 100 and 40 Hz")));
  EXPECT_EQ(usual().add(tracked::self_fed_circuit, {0.1, 0.1, 0.1}, true).study(project).as_built,
            tracked::circuit);
}

TEST(TrackingStudyOfFigures, WhatIsSaidOfOtherReferences) {
  using Shape = tracking::Reference::Shape;
  Project project = nanopositioner();
  project.choice = Project::Choice::tracking;
  const auto elsewhere = [](double built, double none, const char* stage = "polynomial") {
    TrackedElsewhere out{stage, Shape::sine, 0.5, {}, {}};
    out.designs.resize(2);
    out.designs[0].key = tracked::circuit;
    out.designs[0].at.resize(1);
    out.designs[0].at[0].rms_percent_without_lag = built;
    out.designs[1].key = tracked::none;
    out.designs[1].at.resize(1);
    out.designs[1].at[0].rms_percent_without_lag = none;
    return out;
  };
  EXPECT_THAT(usual().study(project, {elsewhere(3.0, 2.0)}).findings,
              Contains(HasSubstr("sine at 0.5 of the stroke (3 % of range for 2)")));
  EXPECT_THAT(usual().study(project, {elsewhere(2.0, 3.0), elsewhere(3.0, 2.0, "preisach")}).findings,
              Not(Contains(HasSubstr("than without compensation"))));
  // What following the rate takes for granted, a sentence a reference that is no triangle.
  project.track.waveforms = {Shape::triangle, Shape::sine, Shape::two_tone, Shape::decaying_triangle};
  std::vector<std::string> said;
  for (const std::string& one : usual().study(project).findings)
    if (one.starts_with("Reference ")) said.push_back(one);
  EXPECT_THAT(said, ElementsAre(HasSubstr("the mean of the measured |slope| over some periods"),
                                HasSubstr("takes the inner turns for a higher frequency"),
                                HasSubstr("shrinks with the strokes")));
  project.target.disturbance.amplitude.alpha = {0.5, 1.0};
  project.track.amplitudes = {1.0, 0.5};
  said.clear();
  for (const std::string& one : usual().study(project).findings)
    if (one.find("Amplitude gains are those of the last peak") != std::string::npos) said.push_back(one);
  EXPECT_EQ(said.size(), 2u);  // not of a sine, whose peaks are alike
  // Above the last frequency of the gains.
  project.target.disturbance.rate.frequency = {Hertz{1.0}, Hertz{40.0}};
  EXPECT_THAT(usual().study(project).findings,
              Contains(HasSubstr("known up to 40 Hz; at 100 Hz the stage keeps")));
  project.target.disturbance.rate.frequency.back() = Hertz{100.0};
  EXPECT_THAT(usual().study(project).findings, Not(Contains(HasSubstr("are known up to"))));
}

TEST(Engines, ARowIsTheWorstOfEachEngineAndOfWhatIsBetweenThem) {
  Figures figures = usual();
  TrackingStudy study = figures.study(nanopositioner());
  study.agreement_percent = 0.01;
  const auto controller = [&](const char* key, double percent) {
    TrackedDesign& one = study.designs.emplace_back();
    one.key = key;
    one.name = key;
    one.at.resize(1);
    one.at[0].rms_percent_without_lag = percent;
  };
  controller("controller_cvode", 0.3);
  controller("controller_at_rest", 0.2);
  CircuitTracked circuit;
  circuit.missing = "too long";
  const std::string name = "the circuit";
  for (const double hz : {10.0, 100.0}) {
    for (tracking::Report* to : {&circuit.by_parts, &circuit.by_ngspice}) {
      tracking::Case& one = to->cases.emplace_back();
      one.frequency = Hertz{hz};
      one.design = name;
      const bool parts = to == &circuit.by_parts;
      one.rms_percent_without_lag = (parts ? 2.0 : 2.2) + hz / 1000.0;
      one.displacement = {0.0, 1.0, 0.0, 1.0};
      if (!parts) one.displacement[1] = 1.0 + hz / 100.0;
    }
  }
  BoardsInTime board{std::string(tracked::sections),
                     {{Hertz{100.0}, 0.1, 0.4, 0.001}, {Hertz{10.0}, 1.0, 0.2, 0.05}},
                     "ngspice ran at 100 Hz",
                     "images"};
  const std::vector<EngineRow> rows =
      engine_rows(study, figures.report, circuit, {board, {"absent", {}, "", ""}});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].closed_form_percent, 0.2);
  EXPECT_EQ(rows[0].cvode_percent, 0.3);
  EXPECT_FALSE(rows[0].ngspice_percent);
  EXPECT_EQ(rows[0].agreement_percent, 0.01);
  EXPECT_THAT(rows[0].missing, ngspice::is_available() ? testing::Matcher<std::string>("too long")
                                                       : HasSubstr("not installed"));
  EXPECT_EQ(rows[1].what, name);
  EXPECT_EQ(rows[1].cvode_percent, 2.4);
  EXPECT_EQ(rows[1].closed_form_percent, 2.1);
  EXPECT_NEAR(*rows[1].ngspice_percent, 2.3, 1e-12);
  EXPECT_EQ(rows[1].missing, "");
  // Displacements 1 apart at one of four samples of a range of 2, at 100 Hz.
  EXPECT_NEAR(*rows[1].agreement_percent, std::max(0.25, 100.0 * 0.5 / 1.0), 1e-6);
  EXPECT_EQ(rows[2].closed_form_percent, 2.5);
  EXPECT_EQ(rows[2].ngspice_percent, 0.4);
  EXPECT_EQ(rows[2].agreement_percent, 0.05);
  EXPECT_THAT(rows[2].missing, HasSubstr("nothing to CVODE; images; ngspice ran at 100 Hz"));
  EXPECT_THAT(
      engine_warnings(rows),
      ElementsAre(HasSubstr(name),
                  "the sections: at 100 Hz 2.5 % of range by closed form, 0.4 by ngspice over 0.1 s: images",
                  HasSubstr("the sections: its engines are 0.05 % of range apart in time, more than 0.02")));
  const report::Table table = engine_table(rows);
  EXPECT_THAT(table.rows[0], ElementsAre("analog controller", "0.2000", "0.3000", "absent", "0.0100"));
  EXPECT_THAT(table.rows[2], ElementsAre("the sections", "2.5000", "no ODE", "0.4000", "0.0500"));
  EXPECT_TRUE(engine_warnings({rows[0], {.what = "x", .agreement_percent = 0.02}}).empty());
}

}  // namespace
}  // namespace bodesmith::project
