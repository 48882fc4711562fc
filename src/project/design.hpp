#pragma once

#include <complex>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "approximate/approximate.hpp"
#include "circuit/realise.hpp"
#include "controller/controller.hpp"
#include "fit/cascade_fit.hpp"
#include "fit/waveform_error.hpp"
#include "fpaa/plan.hpp"
#include "multiplier_layout/layout.hpp"
#include "project/alternatives.hpp"
#include "project/analog_controller.hpp"
#include "project/project.hpp"
#include "spice/compensator_check.hpp"

namespace bodesmith::project {

/// Everything between the target points and the hardware.
struct Design {
  CascadeFit fit;
  CascadeApproximation approximation;
  std::vector<Alternative> alternatives;
  std::size_t chosen = 0;  ///< of the alternatives: what plan and circuit are made of
  std::optional<fpaa::Plan> plan;
  std::optional<circuit::Realised> circuit;
  multiplier_layout::Layout layout;
  std::shared_ptr<const controller::AnalogController> controller;  ///< null: no op-amps, or it cannot be made
  std::vector<std::string> passed_over;  ///< better alternatives that the hardware cannot make, and why
  double compute_s = 0.0;  ///< fit to plan, netlist and layout, without the alternatives that are not built
  double alternatives_s = 0.0;

  const Alternative& built() const { return alternatives[chosen]; }
  const Sections& sections() const { return built().sections; }
};

class AlternativeHardware;
/// Called as soon as the alternatives are known, so that what they become is made meanwhile.
using AlternativesKnown = std::function<void(const std::shared_ptr<AlternativeHardware>&)>;

/// Fits, approximates and ranks the alternatives, and takes the first one that board and parts can make. Throws
/// DesignError (with the last refusal) when they can make none.
Design make_design(const Project& project);
/// The same with the project's analog controller, which somebody else makes beside it.
Design make_design(const Project& project, const std::shared_future<AnalogControllerMade>& controller,
                   const AlternativesKnown& known);

/// The same design with another alternative chosen, made on the board and of the parts by itself; what cannot be made stays
/// empty, and why is added to `refused`. The one that is built already stays as it is.
Design with_alternative(const Project& project, const Design& design, AlternativeHardware& hardware,
                        std::size_t chosen, std::vector<std::string>& refused);

/// The frequencies at which the stages are compared: the target points and every corner of cascade and sections.
Band design_band(const Project& project, const Design& design);
Band design_band(const Project& project, const Cascade& cascade, const Sections& sections);

/// One stage of the design as a frequency response that can be compared with the others.
struct DesignStage {
  std::string name;  ///< "cascade", "sections", "fpaa", "fpaa with holds", "circuit", "circuit with op-amps"
  std::optional<std::size_t> previous;  ///< index of the stage it is made from; absent for the first
  std::function<std::complex<double>(RadPerSecond)> response;
};
/// The stages refer to `design`, which must outlive them.
std::vector<DesignStage> design_stages(const Design& design);

}  // namespace bodesmith::project
