#include "project/design/alternatives.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace bodesmith::project
