#include "project/design/controllers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace bodesmith::project {
namespace {

// A run goes on with what is left: boards, cascades, circuits.
TEST(Controllers, NoneIsBuiltWhoseSlopeDetectorMissesTheReference) {
  Provenance from;
  Project project = ProjectSource::read(std::filesystem::path(BODESMITH_SOURCE_DIR) /
                                        "examples/nanopositioner/project.toml")
                        .project(from);
  EXPECT_TRUE(make_analog_controller(project).controller);
  project.track.frequency.push_back(Hertz{1e-3});
  const AnalogControllerMade made = make_analog_controller(project);
  EXPECT_FALSE(made.controller);
  ASSERT_EQ(made.passed_over.size(), 3u);
  EXPECT_THAT(made.passed_over, testing::Each(testing::HasSubstr("misses the turns")));
}

}  // namespace
}  // namespace bodesmith::project
