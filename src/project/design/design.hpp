#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "approximate/approximate.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/direct/direct_fit.hpp"
#include "fit/waveform/waveform_error.hpp"
#include "fpaa/plan/plan.hpp"
#include "project/design/alternative_hardware.hpp"
#include "project/design/alternatives.hpp"
#include "project/design/controllers.hpp"
#include "project/design/design_stage.hpp"
#include "project/project.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/generator/circuit.hpp"
#include "synthesis/realise_search.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::project {

/// Everything between the target and the hardware.
struct Design {
  std::string how;  ///< a sentence: what was made of the target, and why that; empty with a plant
  std::optional<CascadeFit> fit;  ///< points that became a cascade: those of a stage always
  std::optional<CascadeApproximation> approximation;  ///< of it
  std::optional<DirectFit> direct;        ///< points or a fractional transfer that became sections
  std::vector<Alternative> alternatives;  ///< one without a plant
  std::size_t chosen = 0;                 ///< of the alternatives: what plan and circuit are made of
  std::optional<fpaa::Plan> plan;
  std::string no_plan;  ///< why not, where a board was asked for; with a plant another alternative is taken
  std::optional<fpaa::Plan>
      paper_plan;  ///< of the cascade's sections as the disturbance paper has it: one chip, one clock
  std::optional<synthesis::BuildChoice> circuit;
  std::optional<tolerance::Result> yield;               ///< of the circuit; not with a plant
  std::optional<generator::DisturbanceCircuit> layout;  ///< of a plant's disturbance
  std::shared_ptr<const generator::DisturbanceCircuit>
      controller;                        ///< null: no op-amps, or it cannot be made
  std::vector<std::string> passed_over;  ///< better alternatives that the hardware cannot make, and why
  std::vector<std::string> not_tried;    ///< in the time given
  double compute_s = 0.0;  ///< fit to plan, netlist and layout, without the alternatives that are not built
  double alternatives_s = 0.0;

  const synthesis::Realised& realised() const { return circuit->best.made; }
  const Alternative& built() const { return alternatives[chosen]; }
  const Sections& sections() const { return built().sections; }
  Band band(const Project& project) const { return design_band(project, fit, sections()); }
};

/// Of a stage the first alternative, in the project's order, that board and parts can make, and the layout: a DesignError (with
/// the last refusal) when they can make none. Else the one that there is: a DesignError where no parts can make it, and where
/// the board cannot Design::no_plan.
void choose_alternative(const Project& project, AlternativeHardware& hardware, Design& design);
/// What tolerances do to the circuit of a project without a plant.
void add_tolerances(const Project& project, AlternativeHardware& hardware, Design& design);
/// The controller with the forms that were passed over.
void add_controller(const AnalogControllerMade& made, Design& design);
/// "cascade" (where there is one), "sections", "fpaa", "fpaa with holds", "circuit", "circuit with op-amps"; without a plant the
/// hardware as it is alone. They refer to `design`.
std::vector<DesignStage> design_stages(const Project& project, const Design& design);

}  // namespace bodesmith::project
