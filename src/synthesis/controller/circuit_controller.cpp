#include "synthesis/controller/circuit_controller.hpp"

#include <fmt/format.h>

#include "synthesis/controller/as_built.hpp"

namespace bodesmith::controller {

std::string CircuitController::name() const {
  return fmt::format("analog controller, {} ({})", to_string(controller_->form),
                     options_ ? "ngspice" : "CVODE");
}

int CircuitController::part_count() const {
  const AnalogController& c = *controller_;
  return static_cast<int>(c.parts.size() + c.opamps.size() + c.multipliers.size() + c.contacts.size() +
                          c.sources.size());
}

tracking::DriveWaveform CircuitController::drive(const tracking::Reference& reference,
                                                 Hertz operating) const {
  const SteadyState run = options_ ? run_in_ngspice(*controller_, reference, operating, *options_)
                                   : run_in_cvode(*controller_, reference, operating);
  return {run.v, run.step_s};
}

}  // namespace bodesmith::controller
