#pragma once

#include <memory>
#include <optional>
#include <string>

#include "synthesis/controller/as_built.hpp"
#include "tracking/built_controller.hpp"

namespace bodesmith::controller {

/// The circuit for a tracking study: its netlist in ngspice, or without it by CVODE.
class CircuitController final : public tracking::BuiltController {
 public:
  explicit CircuitController(std::shared_ptr<const AnalogController> controller,
                             std::optional<NgspiceRun> options = NgspiceRun())
      : controller_(std::move(controller)), options_(options) {}

  std::string key() const override { return options_ ? "controller_circuit" : "controller_cvode"; }
  std::string name() const override;
  int part_count() const override;
  tracking::DriveWaveform drive(const tracking::Reference& reference, Hertz operating) const override;
  const AnalogController& circuit() const { return *controller_; }

 private:
  std::shared_ptr<const AnalogController> controller_;
  std::optional<NgspiceRun> options_;
};

}  // namespace bodesmith::controller
