#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "fpaa/device/mismatch.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::fpaa {

/// A plan as its switches make it, at the frequencies of a grid, as a function of what its capacitors really are:
/// for boards that are drawn with mismatch, and for the one that was measured. The capacitors are those of all
/// CAMs one behind the other, in the plan's order.
class DrawnBoard {
 public:
  /// Throws DesignError as SwitchedBoard does. The plan must outlive it.
  DrawnBoard(const Plan& plan, std::vector<Hertz> grid) : board_(plan), grid_(std::move(grid)) {}
  DrawnBoard(SwitchedBoard board, std::vector<Hertz> grid)
      : board_(std::move(board)), grid_(std::move(grid)) {}

  const std::vector<Hertz>& grid() const { return grid_; }
  std::size_t capacitor_count() const { return nominal_units().size(); }
  /// As the plan has them.
  const std::vector<double>& nominal_units() const { return board_.nominal_units(); }
  /// "chip1.Section1a.Ca".
  const std::vector<std::string>& names() const { return board_.names(); }

  /// From the input pin to the output pin, at the grid.
  std::vector<Complex> response(std::span<const double> units) const;
  /// d H / d ln C of every capacitor: [capacitor][frequency].
  std::vector<std::vector<Complex>> slopes(std::span<const double> units) const;
  /// d ln H / d ln C, likewise.
  std::vector<std::vector<Complex>> sensitivities(std::span<const double> units) const;
  const PlanGraph& graph() const { return board_.graph(); }
  const SwitchedBoard& board() const { return board_; }
  /// Where the first-order variance of the response is largest over the grid, each capacitor's share of it, largest first.
  struct Share {
    std::string capacitor;
    double share = 0.0;
  };
  std::vector<Share> variance_shares(const MismatchModel& mismatch) const;

 private:
  SwitchedBoard board_;  ///< copied where other capacitors are tried
  std::vector<Hertz> grid_;
};

}  // namespace bodesmith::fpaa
