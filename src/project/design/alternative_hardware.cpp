#include "project/design/alternative_hardware.hpp"

namespace bodesmith::project {
namespace {

fpaa::PlanOptions plan_options(const Project& project, const Band& band) {
  fpaa::PlanOptions options = *project.fpaa;
  options.band = band;
  return options;
}

Outcome<fpaa::Plan> try_plan(const Sections& sections, const fpaa::PlanOptions& options) {
  if (integrates(sections)) return Refusal{"the sections have a pole at 0, which a plan does not make"};
  try {
    return fpaa::make_plan(sections, options);
  } catch (const DesignError& error) {
    return Refusal{error.what()};
  }
}

}  // namespace

std::optional<fpaa::Plan> make_paper_plan(const Project& project, const Sections& sections, Band band) {
  if (!project.fpaa) return std::nullopt;
  fpaa::PlanOptions options = plan_options(project, band);
  options.topology = fpaa::PlanOptions::Topology::bilinear;
  Outcome<fpaa::Plan> made = fpaa::make_plan(sections, options);
  if (refusal_of(made) != nullptr) return std::nullopt;
  return std::get<fpaa::Plan>(std::move(made));
}

Sections stating_band(Sections sections, Band band) {
  if (!sections.error) sections.error = Sections::Error{};
  sections.error->band = band;
  return sections;
}

AlternativeHardware::AlternativeHardware(const Project& project, const std::optional<CascadeFit>& fit,
                                         const std::vector<Alternative>& alternatives)
    : project_(project) {
  for (const Alternative& alternative : alternatives) {
    Place& place = places_.emplace_back();
    place.sections = alternative.sections;
    place.band = design_band(project, fit, alternative.sections);
  }
}

const std::optional<Outcome<synthesis::BuildChoice>>& AlternativeHardware::circuit_of(
    std::size_t alternative) {
  Place& place = places_[alternative];
  std::call_once(place.circuit_once, [&] {
    if (!project_.circuit) return;
    synthesis::BuildSearch search;
    search.options.realisation = project_.circuit->realisation;
    search.options.resistors = synthesis::Series::named(project_.circuit->resistors);
    search.options.capacitors = synthesis::Series::named(project_.circuit->capacitors);
    search.options.tolerances = project_.tolerances();
    search.may_choose = !project_.plant && search.options.realisation == Project::Circuit{}.realisation;
    place.circuit = synthesis::realise_for_building(
        project_.plant ? place.sections : stating_band(place.sections, place.band), search);
  });
  return place.circuit;
}

const std::optional<Outcome<fpaa::Plan>>& AlternativeHardware::plan_of(std::size_t alternative) {
  Place& place = places_[alternative];
  std::call_once(place.plan_once, [&] {
    if (project_.fpaa) place.plan = try_plan(place.sections, plan_options(project_, place.band));
    place.built = true;
  });
  return place.plan;
}

const std::optional<Outcome<fpaa::Plan>>& AlternativeHardware::compared_plan_of(std::size_t alternative) {
  Place& place = places_[alternative];
  std::call_once(place.compared_once, [&] {
    if (project_.fpaa && !place.built) {
      fpaa::PlanOptions options = plan_options(project_, place.band);
      options.quick = true;
      place.compared_plan = try_plan(place.sections, options);
      if (refusal_of(*place.compared_plan) != nullptr) place.compared_plan.reset();
    }
    if (!place.compared_plan) place.compared_plan = plan_of(alternative);
    place.compared = true;
  });
  return place.compared_plan;
}

}  // namespace bodesmith::project
