#include "project/design/alternatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "base/files.hpp"
#include "project/make_design.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::project {
namespace {

/// The nanopositioner's project with other lines at its end, and without [approximate].
Project project_with(const std::string& tables) {
  const std::filesystem::path example =
      std::filesystem::path(BODESMITH_SOURCE_DIR) / "examples/nanopositioner";
  const TemporaryFolder folder;
  write_file(folder / "gains.csv", read_file(example / "gains.csv"));
  write_file(folder / "disturbance.json", read_file(example / "disturbance.json"));
  write_file(folder / "project.toml",
             "schema = \"bodesmith.project/1\"\n[target]\npoints = \"gains.csv\"\ndisturbance = "
             "\"disturbance.json\"\n"
             "[plant]\nstroke_m = 1e-6\n[track]\nfrequency_hz = [1, 10, 20, 60, 100]\n" +
                 tables);
  Provenance from;
  return ProjectSource::read(folder / "project.toml").project(from);
}

TEST(Alternatives, FewestSectionsMeetThePoints) {
  const Design design = make_design(project_with("[choose]\nby = \"fewest_sections\"\n"));
  const Alternative& chosen = design.alternatives[design.chosen];
  EXPECT_LE(chosen.points_max_db, 0.05);
  EXPECT_LE(chosen.sections.pole_count(), 3) << "three real poles go through all five points";
  for (const Alternative& other : design.alternatives) {
    if (other.points_max_db <= 0.05) {
      EXPECT_GE(other.sections.pole_count(), chosen.sections.pole_count()) << other.name;
    }
  }
}

TEST(Alternatives, TheWaveformsBestIsBuiltOnRequest) {
  const Design design = make_design(project_with("[choose]\nby = \"waveform\"\n"));
  const Alternative& chosen = design.alternatives[design.chosen];
  EXPECT_EQ(chosen.kind, Alternative::Kind::waveform);
  for (const Alternative& other : design.alternatives) {
    EXPECT_GE(other.waveform.worst_percent, chosen.waveform.worst_percent) << other.name;
  }
}

TEST(Alternatives, WhatTheBoardCannotMakeIsPassedOverAndSaid) {
  const Design design =
      make_design(project_with("[choose]\nby = \"waveform\"\n[hardware.fpaa]\nclock_hz = 2000.0\n"));
  ASSERT_TRUE(design.plan);
  for (const std::string& reason : design.passed_over)
    EXPECT_NE(reason.find("expected"), std::string::npos) << reason;
  EXPECT_EQ(design.alternatives[design.chosen].kind, Alternative::Kind::waveform);
}

TEST(Alternatives, WhatWasAskedForIsBuilt) {
  const Design design = make_design(project_with("[approximate]\norder = 3\n[choose]\nby = \"as_asked\"\n"));
  EXPECT_EQ(design.chosen, 0u);
  EXPECT_EQ(design.sections().pole_count(), 12);
}

TEST(Alternatives, AreTriedInTheOrderThatTheProjectChooses) {
  Project project;
  std::vector<Alternative> all(4);
  const double tracked[] = {3.0, 1.0, 2.0, 1.0}, worst[] = {1.0, 4.0, 3.0, 2.0},
               points[] = {0.0, 0.05, 0.2, 0.3};
  const int poles[] = {4, 3, 1, 2};
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].tracked_percent = tracked[i];
    all[i].waveform.worst_percent = worst[i];
    all[i].points_max_db = points[i];
    all[i].sections.sections.resize(static_cast<std::size_t>(poles[i]));
    for (Section& one : all[i].sections.sections) one.poles = {-1.0};
  }
  using Order = std::vector<std::size_t>;
  const auto order = [&](Project::Choice by, std::optional<double> limit = {}) {
    project.choice = by;
    project.limits.points_db = limit;
    return rank_alternatives(project, all);
  };
  EXPECT_EQ(order(Project::Choice::tracking), (Order{1, 3, 2, 0}));
  EXPECT_EQ(order(Project::Choice::waveform), (Order{0, 3, 2, 1}));
  EXPECT_EQ(order(Project::Choice::as_asked), Order{0});
  EXPECT_EQ(order(Project::Choice::fewest_sections), (Order{1, 0}));
  EXPECT_EQ(order(Project::Choice::fewest_sections, 0.2), (Order{2, 1, 0}));
  all[0].points_max_db = 1.0;
  EXPECT_EQ(order(Project::Choice::fewest_sections, 0.01), Order{0});
}

TEST(Alternatives, TheBandHoldsPointsAndCorners) {
  Project project;
  project.target.band = {Hertz{3.0}, Hertz{4.0}};
  Sections sections;
  sections.sections = {Section::pole_zero(1.0, Hertz{0.5}.rad_s(), Hertz{30.0}.rad_s())};
  const Band own = design_band(project, {}, sections);
  EXPECT_EQ(own.from.value, 3.0);
  EXPECT_EQ(own.to.value, 4.0);
  project.plant = Project::Plant{};
  project.target.points.points = {{Hertz{1.0}, 1.0, {}}, {Hertz{20.0}, 1.0, {}}};
  CascadeFit fit;
  const Band wide = design_band(project, fit, sections);
  EXPECT_NEAR(wide.from.value, 0.5, 1e-9);
  EXPECT_NEAR(wide.to.value, 30.0, 1e-9);
  sections.sections = {Section::pole_zero(1.0, Hertz{2.0}.rad_s(), Hertz{3.0}.rad_s())};
  EXPECT_EQ(design_band(project, fit, sections).from.value, 1.0);
  EXPECT_EQ(design_band(project, fit, sections).to.value, 20.0);
  // The base's own gain is no condition.
  project.target.base = Hertz{1.0};
  project.target.points.points[0].gain = 100.0;
  project.target.points.points[1].gain = 2.0;
  EXPECT_NEAR(max_error_at_points(project, [](RadPerSecond) { return Complex(0.0, 1.0); }),
              20.0 * std::log10(2.0), 1e-9);
}

}  // namespace
}  // namespace bodesmith::project
