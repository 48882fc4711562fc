#include "project/alternative_hardware.hpp"

#include <future>

#include "base/error.hpp"
#include "project/design.hpp"

namespace bodesmith::project {
namespace {

fpaa::PlanOptions plan_options(const Project& project, const Band& band) {
  fpaa::PlanOptions options;
  options.board = project.fpaa->board;
  options.clock = project.fpaa->clock;
  options.band = band;
  return options;
}

circuit::RealiseOptions circuit_options(const Project& project) {
  circuit::RealiseOptions options;
  options.realisation = project.circuit->realisation;
  options.resistors = circuit::Series::named(project.circuit->resistors);
  options.capacitors = circuit::Series::named(project.circuit->capacitors);
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

AlternativeHardware::AlternativeHardware(const Project& project, const Design& design) : project_(project) {
  for (const Alternative& alternative : design.alternatives) {
    Place& place = places_.emplace_back();
    place.sections = alternative.sections;
    place.band = design_band(project, design.fit.cascade, alternative.sections);
  }
}

void AlternativeHardware::make(Place& place) const {
  // The plan's search takes longest: parts are looked for beside it.
  std::future<Outcome<fpaa::Plan>> planned;
  if (project_.fpaa) {
    planned = std::async(std::launch::async,
                         [this, &place] { return try_plan(project_, place.sections, place.band); });
  }
  if (project_.circuit) place.made.circuit = circuit::try_realise(place.sections, circuit_options(project_));
  if (planned.valid()) place.made.plan = planned.get();
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
