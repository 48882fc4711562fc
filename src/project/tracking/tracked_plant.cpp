#include "project/tracking/tracked_plant.hpp"

#include <limits>

#include "base/error.hpp"
#include "lti/section_making.hpp"
#include "tracking/model_stage.hpp"
#include "tracking/track.hpp"

namespace bodesmith::project {

tracking::Plant tracking_plant(const Project& project) {
  const Project::Plant& given = *project.plant;
  tracking::Plant plant;
  plant.disturbance = project.target.disturbance;
  plant.stroke = given.stroke_m;
  if (given.amplifier_corner) plant.drive_path = tracking::lowpass_path(*given.amplifier_corner);
  std::vector<Sections> stage;
  if (given.damping_compensator) {
    Sections damping;
    damping.sections = {*given.damping_compensator};
    stage.push_back(damping);
  }
  if (given.resonance) stage.push_back(tracking::resonance_path(*given.resonance, given.damping_ratio));
  if (!stage.empty()) plant.stage_path = in_series(stage);
  return plant;
}

tracking::PolynomialStage own_stage(const Project& project) {
  const tracking::Plant plant = tracking_plant(project);
  return {plant.disturbance, plant.paths(), {.alpha = project.track.amplitude()}};
}

tracking::Options tracking_options(const Project& project) {
  tracking::Options options;
  options.frequencies = project.track.frequency;
  // A compensator stands in the path of its own branch; the switch selects behind it (disturbance paper,
  // Fig. 2).
  options.place = tracking::Options::Place::before_switch;
  options.reference = project.track.waveform();
  options.alpha = project.track.amplitude();
  return options;
}

tracking::Design compensated_design(const Project& project, std::string name,
                                    tracking::Compensator compensator, tracking::GeneratorForm form) {
  tracking::Design design{std::move(name), tracking::ConstantGain{}, tracking::ConstantGain{}, "", form};
  (project.target.branch == Disturbance::Branch::ascending ? design.ascending : design.descending) =
      std::move(compensator);
  return design;
}

std::vector<double> tracked_percents(const Project& project, const tracking::Design& design) {
  tracking::Options options = tracking_options(project);
  options.time_domain = false;
  std::vector<double> out;
  try {
    const tracking::Report report = tracking::track(tracking_plant(project), {design}, options);
    for (const Hertz f : options.frequencies)
      out.push_back(report.find(f, design.name)->rms_percent_without_lag);
  } catch (const DesignError&) {
    out.assign(options.frequencies.size(), std::numeric_limits<double>::infinity());
  }
  return out;
}

}  // namespace bodesmith::project
