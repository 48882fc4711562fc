#include "faults/plan_board.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "numeric/index.hpp"

namespace bodesmith::faults {

/// One board that is set up once: from one further fault to the next only the CAMs that change are made anew.
class PlanBoard::Changed final : public ChangedBoard {
 public:
  Changed(const PlanBoard& board, const Effect& first)
      : of_(board),
        first_(first),
        plan_(first.clocks.empty() ? fpaa::Plan() : board.with_clocks(first)),
        board_(first.clocks.empty() ? board.drawn_->board() : fpaa::SwitchedBoard(plan_)) {}

  Eigen::VectorXcd response(const Effect& further) const override {
    if (!further.clocks.empty()) return of_.response(joined(first_, further));
    board_.set_units(of_.units_of(joined(first_, further)));
    Eigen::VectorXcd out(eigen_index(of_.grid_.size()));
    for (std::size_t k = 0; k < of_.grid_.size(); ++k)
      out(eigen_index(k)) = board_.gain(of_.grid_[k].rad_s());
    return out;
  }

 private:
  const PlanBoard& of_;
  Effect first_;
  fpaa::Plan plan_;  ///< of the first fault's clocks
  mutable fpaa::SwitchedBoard board_;
};

PlanBoard::PlanBoard(const fpaa::Plan& plan, Measurement measured, const Spread& spread)
    : Board(std::move(measured)), plan_(plan), mismatch_(spread.mismatch) {
  for (const Channel& channel : this->measured().channels) {
    if (channel.node != "out")
      throw InputError(
          fmt::format("{}: of an FPAA plan only the output can be measured, expected no node '{}'",
                      channel.file, channel.node));
    grid_.insert(grid_.end(), channel.grid.begin(), channel.grid.end());
  }
  drawn_ = std::make_unique<fpaa::DrawnBoard>(plan_, grid_);
  for (std::size_t n = 0; n < graph().nodes.size(); ++n)
    cam_of_.insert(cam_of_.end(), graph().nodes[n].cam->capacitors.size(), n);
  for (const double n : units()) sigma_.push_back(mismatch_.relative_sigma(n));
  set_good(response({}));
  const auto sensitivities = drawn_->sensitivities(drawn_->nominal_units());
  slopes_.resize(eigen_index(grid_.size()), eigen_index(sigma_.size()));
  for (std::size_t c = 0; c < sigma_.size(); ++c) {
    for (std::size_t k = 0; k < grid_.size(); ++k)
      slopes_(eigen_index(k), eigen_index(c)) = sigma_[c] * sensitivities[c][k];
  }
}

fpaa::Plan PlanBoard::with_clocks(const Effect& effect) const {
  fpaa::Plan out = plan_;
  std::vector<fpaa::PlacedCam*> cams;
  for (fpaa::ChipPlan& chip : out.chips) {
    for (fpaa::PlacedCam& cam : chip.cams) cams.push_back(&cam);
  }
  for (const auto& [cam, factor] : effect.clocks) cams[cam]->clock_a.value *= factor;
  return out;
}

bool PlanBoard::can_run(const Effect& effect) const {
  const fpaa::Plan plan = with_clocks(effect);
  if (refusal_of(fpaa::plan_graph(plan)) != nullptr) return false;
  try {
    const fpaa::SwitchedBoard board(plan);
    return true;
  } catch (const DesignError&) {  // clocks that have no manageable common period
    return false;
  }
}

std::vector<double> PlanBoard::units_of(const Effect& effect) const {
  std::vector<double> units = drawn_->nominal_units();
  for (const auto& [capacitor, value] : effect.units) units[capacitor] = value;
  for (double& n : units) n = mismatch_.drawn(n, 0.0);
  return units;
}

Eigen::VectorXcd PlanBoard::response(const Effect& effect) const {
  return Changed(*this, effect).response({});
}

std::unique_ptr<ChangedBoard> PlanBoard::changed_by(const Effect& effect) const {
  return std::make_unique<Changed>(*this, effect);
}

Prediction PlanBoard::predict(const Effect& effect) const {
  return {response(effect), slopes_, effect.model_error, {}};
}

}  // namespace bodesmith::faults
