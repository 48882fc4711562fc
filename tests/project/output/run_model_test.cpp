#include "project/output/run_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "project/design/controllers.hpp"
#include "project/project.hpp"
#include "signal/statistics.hpp"
#include "synthesis/controller/as_built.hpp"
#include "tracking/reference.hpp"

namespace bodesmith::project {
namespace {

Project half_a_stroke() {
  Provenance from;
  const std::filesystem::path root = BODESMITH_SOURCE_DIR;
  Project project = ProjectSource::read(root / "examples/nanopositioner/project.toml").project(from);
  project.track.frequency = {Hertz{10.0}};
  project.track.amplitudes = {0.5};
  return project;
}

// The circuit has the full stroke's polynomials and no gains for another one: at half the stroke it makes what these make there.
TEST(ControllerAtRest, MakesAtHalfAStrokeWhatCvodeMakesOfTheCircuit) {
  const Project project = half_a_stroke();
  const auto circuit = make_analog_controller(project).controller;
  ASSERT_NE(circuit, nullptr);
  const tracking::Reference half(tracking::Reference::Shape::triangle, 0.5);
  std::vector<double> at_rest = controller_at_rest(project, circuit)->drive(half, Hertz{10.0}).v;
  std::vector<double> by_cvode =
      generator::CircuitController(circuit, std::nullopt).drive(half, Hertz{10.0}).v;
  ASSERT_EQ(by_cvode.size() % at_rest.size(), 0u);
  const std::size_t every = by_cvode.size() / at_rest.size();
  // Off the turns, where the drive jumps.
  double worst = 0.0;
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    const std::size_t from_turn = i % (at_rest.size() / 2);
    if (from_turn < 5 || from_turn + 5 > at_rest.size() / 2) continue;
    worst = std::max(worst, std::abs(at_rest[i] - by_cvode[every * i]));
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(*std::ranges::max_element(at_rest) - *std::ranges::min_element(at_rest), 0.45);
}

// With amplitude gains its divider and held stroke make v = r - d(v) of the polynomials at that stroke; the parts are of a series.
TEST(ControllerAtRest, AmplitudeGainsMakeThePolynomialsOfTheStroke) {
  Project project = half_a_stroke();
  project.target.disturbance.amplitude = {{0.25, 0.5, 1.0}, {0.2, 0.42, 1.0}, {0.3, 0.58, 1.0}};
  const auto circuit = make_analog_controller(project).controller;
  ASSERT_NE(circuit, nullptr);
  ASSERT_TRUE(circuit->stroke.has_value());
  const tracking::Reference half(tracking::Reference::Shape::triangle, 0.5);
  const std::vector<double> made = controller_at_rest(project, circuit)->drive(half, Hertz{10.0}).v;
  const Disturbance d = project.target.disturbance.at(0.5, Hertz{10.0});
  const std::vector<double> wanted = half.samples(made.size());
  double worst = 0.0;
  for (std::size_t i = 5; i + 5 < made.size(); ++i) {
    if (std::abs(static_cast<double>(i) - 0.5 * static_cast<double>(made.size())) < 5.0) continue;
    const double r = wanted[i];
    const auto branch =
        2 * i < made.size() ? Disturbance::Branch::ascending : Disturbance::Branch::descending;
    worst = std::max(worst, std::abs(made[i] + d.value(branch, made[i]) - r));
  }
  EXPECT_LT(worst, 4e-3);
}

}  // namespace
}  // namespace bodesmith::project
