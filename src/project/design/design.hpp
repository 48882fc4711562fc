#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "approximate/approximate.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/waveform/waveform_error.hpp"
#include "fpaa/plan/plan.hpp"
#include "project/design/alternative_hardware.hpp"
#include "project/design/alternatives.hpp"
#include "project/design/controllers.hpp"
#include "project/design/design_stage.hpp"
#include "project/project.hpp"
#include "synthesis/controller/controller.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/generator/layout.hpp"
#include "synthesis/realise_search.hpp"

namespace bodesmith::project {

/// Everything between the target points and the hardware.
struct Design {
  CascadeFit fit;
  CascadeApproximation approximation;
  std::vector<Alternative> alternatives;
  std::size_t chosen = 0;  ///< of the alternatives: what plan and circuit are made of
  std::optional<fpaa::Plan> plan;
  std::optional<fpaa::Plan>
      paper_plan;  ///< of the cascade's sections as the disturbance paper has it: one chip, one clock
  std::optional<synthesis::BuildChoice> circuit;
  generator::Layout layout;
  std::shared_ptr<const controller::AnalogController> controller;  ///< null: no op-amps, or it cannot be made
  std::vector<std::string> passed_over;  ///< better alternatives that the hardware cannot make, and why
  double compute_s = 0.0;  ///< fit to plan, netlist and layout, without the alternatives that are not built
  double alternatives_s = 0.0;

  const synthesis::Realised& realised() const { return circuit->best.made; }
  const Alternative& built() const { return alternatives[chosen]; }
  const Sections& sections() const { return built().sections; }
};

/// Fits, approximates and makes the alternatives; nothing is chosen yet.
Design make_alternative_designs(const Project& project);
/// Takes the first alternative, in the project's order, that board and parts can make, and adds the layout. Throws DesignError
/// (with the last refusal) when they can make none.
void choose_alternative(const Project& project, AlternativeHardware& hardware, Design& design);
/// The controller with the forms that were passed over.
void add_controller(const AnalogControllerMade& made, Design& design);
/// All of it, one after the other.
Design make_design(const Project& project);

Band design_band(const Project& project, const Design& design);

/// "cascade", "sections", "fpaa", "fpaa with holds", "circuit", "circuit with op-amps"; they refer to `design`.
std::vector<DesignStage> design_stages(const Design& design);

}  // namespace bodesmith::project
