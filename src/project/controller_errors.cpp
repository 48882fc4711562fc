#include "project/controller_errors.hpp"

#include <algorithm>

#include "project/tracked_plant.hpp"

namespace bodesmith::project {
namespace {

/// `yield controller` draws more.
constexpr std::uint64_t kCopies = 400;

}  // namespace

std::optional<part_errors::Report> examine_controller(
    const Project& project, const std::shared_ptr<const controller::AnalogController>& controller) {
  if (!controller || project.track.frequency.empty()) return std::nullopt;
  const tracking::Plant plant = tracking_plant(project);
  tracking::PolynomialStage::Options stage_options;
  stage_options.alpha = project.track.amplitude();
  const tracking::PolynomialStage stage(plant.disturbance, plant.paths(), stage_options);
  part_errors::ReportOptions options;
  options.study.errors = project.controller.errors;
  options.study.reference =
      tracking::Reference(tracking::Reference::Shape::triangle, project.track.amplitude());
  options.study.frequencies = project.track.frequency;
  std::sort(options.study.frequencies.begin(), options.study.frequencies.end(),
            [](Hertz a, Hertz b) { return a.value < b.value; });
  options.study.draws = options.trims.draws = kCopies;
  options.allow_unstable = project.controller.allow_unstable;
  return part_errors::examine(*controller, stage, options);
}

}  // namespace bodesmith::project
