#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/error.hpp"
#include "fpaa/controller/controller.hpp"
#include "project/tracking/tracking_study.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::project {

/// A controller on the FPAA board as a study sees it: the drive that the board makes, event by event, with
/// the capacitors that the host has sent for the operating frequency (of its sets the nearest).
class BoardController final : public tracking::BuiltController {
 public:
  BoardController(fpaa::ControllerVariant variant, Disturbance disturbance);

  std::string key() const override;   ///< "controller_fpaa_lookup_loop"
  std::string name() const override;  ///< "FPAA controller (lookup, loop)"
  /// CAMs, and parts outside.
  int part_count() const override;
  tracking::DriveWaveform drive(const tracking::Reference& reference, Hertz operating) const override {
    return drive(reference, operating, 0.0);
  }
  /// Its first sample a share of a step after the repeat begins.
  tracking::DriveWaveform drive(const tracking::Reference& reference, Hertz operating, double first) const;
  /// With the capacitors that the host has sent.
  fpaa::ControllerVariant serving(Hertz operating) const;

 private:
  fpaa::ControllerVariant variant_;
  Disturbance disturbance_;
};

/// Those fed by their own drive that fit the project's board, in every way to make the polynomials.
std::vector<fpaa::ControllerVariant> board_controllers(const Project& project);

/// One way of driving the stage, tracked at every frequency.
struct BoardTrackingRow : TrackedDesign {
  std::optional<std::size_t> variant =
      std::nullopt;  ///< of the controller; absent: an ideal drive, for comparison
  std::optional<std::string> why_not = std::nullopt;  ///< it does not fit, or cannot work
  std::vector<std::string> clipped = {};              ///< CAMs that clip
};

struct BoardTracking {
  std::vector<Hertz> frequency;
  std::vector<BoardTrackingRow>
      rows;  ///< no compensation, constant polynomial, then the controller's variants

  Json to_json() const;
  /// `frequency_hz` and a column `<key>_percent` a row that works.
  std::string csv() const;
};

/// Every variant that fits, run at every frequency against the stage: y = v + K(f) d(v) and what stands
/// before and behind it. The error is that of the whole displacement against the reference (disturbance
/// paper, eq. 8).
BoardTracking track_board(const fpaa::Controller& controller, const Disturbance& disturbance,
                          const tracking::Stage& stage, const std::vector<Hertz>& frequencies,
                          const tracking::Reference& reference = tracking::Reference());

/// Takes the variant whose worst tracking error over the frequencies is least; ties (5 %) by fewer CAMs. Only
/// variants that `polynomial` and `structure` allow.
void choose_by_tracking(fpaa::Controller& controller, const BoardTracking& tracking,
                        const fpaa::ControllerOptions& options);

struct TrackedController {
  fpaa::Controller controller;
  BoardTracking tracking;
  double worst_percent() const;  ///< of the chosen variant
};
/// A controller (fpaa::make_controller) run on the board, its variant chosen by that. At the fast clock as it is given; without one
/// (not `clock_is_given`) at 250 kHz, and where that tracks worse than is asked of a board at 1 MHz if that meets it, which the vendor's
/// limit of (1 + gain) fc leaves room for up to a gain of 18.
Outcome<TrackedController> track_controller(const Disturbance& disturbance,
                                            const fpaa::BranchPlans& compensators,
                                            const fpaa::ControllerOptions& options, bool clock_is_given,
                                            const tracking::Stage& stage,
                                            const std::vector<Hertz>& frequencies);

}  // namespace bodesmith::project
