#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "project/tracking/tracked_designs.hpp"
#include "project/tracking/tracking_study.hpp"
#include "tracking/model_stage.hpp"

namespace bodesmith::project {

/// One combination of stage and reference other than the project's first.
struct ElsewhereTask {
  std::string name;
  std::shared_ptr<const tracking::Stage> stage;
  const tracking::IdentifiedStage* identified = nullptr;  ///< the stage, where it is of another family
  tracking::Reference reference;
};

/// What the built controllers do on every stage, which needs no design.
struct ControllersTracked {
  std::vector<TrackedDesign> here;                    ///< on the project's own stage
  std::vector<ElsewhereTask> tasks;                   ///< none when there was no time
  std::vector<std::vector<TrackedDesign>> elsewhere;  ///< one row a task
  /// Greatest rms difference between the drives that ngspice and CVODE find of the analog controller, percent of range;
  /// absent without ngspice.
  std::optional<double> agreement_percent;
};
/// Every controller of the project that can be run here: the analog one in ngspice where that is installed and, along the
/// project's first reference alone, by CVODE and at rest; where tracking decides, those of the board, fed by their own drive.
ControllersTracked track_built_controllers(
    const Project& project, const std::shared_ptr<const generator::DisturbanceCircuit>& analog);

/// The project's other waveforms and amplitudes on its polynomials, by the branch's slope and with closed minor loops;
/// and all of its references on stages of other families (Preisach, Prandtl-Ishlinskii, Bouc-Wen) identified from the
/// same loops. A stage is not its polynomial: what is left there can be as good as the model's own fit, not better.
/// Harmonic by harmonic, of the candidates only those that stand for a way of compensating; then the controllers.
std::vector<TrackedElsewhere> tracked_elsewhere(const Project& project,
                                                const std::vector<TrackedCandidate>& candidates,
                                                const ControllersTracked& controllers);

}  // namespace bodesmith::project
