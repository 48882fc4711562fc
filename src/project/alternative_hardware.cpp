#include "project/alternative_hardware.hpp"

#include "base/error.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::project {
namespace {

fpaa::PlanOptions plan_options(const Project& project, const Band& band) {
  fpaa::PlanOptions options;
  options.board = project.fpaa->board;
  options.clock = project.fpaa->clock;
  options.band = band;
  return options;
}

Outcome<fpaa::Plan> try_plan(const Project& project, const Sections& sections, const Band& band) {
  try {
    return fpaa::make_plan(sections, plan_options(project, band));
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

Outcome<synthesis::BuildChoice> make_circuit(const Project::Circuit& options, Sections sections,
                                             std::optional<Band> band) {
  synthesis::BuildSearch search;
  search.options.realisation = options.realisation;
  search.options.resistors = synthesis::Series::named(options.resistors);
  search.options.capacitors = synthesis::Series::named(options.capacitors);
  search.may_choose = band && options.realisation == Project::Circuit{}.realisation;
  if (band) sections = stating_band(std::move(sections), *band);
  return synthesis::realise_for_building(sections, search);
}

AlternativeHardware::AlternativeHardware(const Project& project, const Cascade& cascade,
                                         const std::vector<Alternative>& alternatives)
    : project_(project) {
  for (const Alternative& alternative : alternatives) {
    Place& place = places_.emplace_back();
    place.sections = alternative.sections;
    place.band = design_band(project, cascade, alternative.sections);
  }
}

void AlternativeHardware::make(Place& place) const {
  // The plan's search takes longest: parts are looked for at the same time.
  parallel_for(2, 2, [&](std::size_t i) {
    if (i == 0 && project_.fpaa) place.made.plan = try_plan(project_, place.sections, place.band);
    if (i == 1 && project_.circuit) place.made.circuit = make_circuit(*project_.circuit, place.sections);
  });
}

const AlternativeHardware::Made& AlternativeHardware::of(std::size_t alternative) {
  Place& place = places_[alternative];
  std::call_once(place.once, [this, &place] {
    make(place);
    place.done = true;
  });
  return place.made;
}

}  // namespace bodesmith::project
