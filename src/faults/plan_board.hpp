#pragma once

#include <memory>

#include "faults/board.hpp"
#include "fpaa/plan/drawn_board.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::faults {

/// An FPAA plan as its switches make it. What differs from board to board are the
/// capacitors' units (fpaa::MismatchModel).
class PlanBoard : public Board {
 public:
  /// Throws InputError for a channel that is not the output, DesignError for wires that are wrong.
  PlanBoard(const fpaa::Plan& plan, Measurement measured, const Spread& spread);

  std::size_t unknowns() const override { return sigma_.size(); }
  bool is_part(std::size_t) const override { return true; }
  /// Slopes are those of the good board: mismatch is small.
  Prediction predict(const Effect& effect) const override;
  Eigen::VectorXcd response(const Effect& effect) const override;
  std::unique_ptr<ChangedBoard> changed_by(const Effect& effect) const override;

  // For the kinds of fault.
  const fpaa::PlanGraph& graph() const { return drawn_->graph(); }
  const std::vector<std::string>& capacitors() const { return drawn_->names(); }
  const std::vector<double>& units() const { return drawn_->nominal_units(); }
  /// The CAM (of graph().nodes) to which a capacitor belongs.
  std::size_t cam_of(std::size_t capacitor) const { return cam_of_[capacitor]; }
  /// Whether the board's clocks can make this.
  bool can_run(const Effect& effect) const;

 protected:
  std::vector<Fault> faults_of(const FaultKind& kind) const override { return kind.on_plan(*this); }

 private:
  class Changed;
  fpaa::Plan with_clocks(const Effect& effect) const;
  /// Of all capacitors.
  std::vector<double> units_of(const Effect& effect) const;

  fpaa::Plan plan_;
  fpaa::MismatchModel mismatch_;
  std::vector<Hertz> grid_;
  std::unique_ptr<fpaa::DrawnBoard> drawn_;
  std::vector<std::size_t> cam_of_;
  std::vector<double> sigma_;
  Eigen::MatrixXcd slopes_;
};

}  // namespace bodesmith::faults
