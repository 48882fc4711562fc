#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "fpaa/mismatch.hpp"
#include "fpaa/plan_graph.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith {
class Random;
}

namespace bodesmith::fpaa {

/// A plan as it runs (every clock, hold and half cycle), as a function of what its capacitors really are: for
/// boards that are drawn with mismatch, and for the one that was measured. The capacitors are those of all
/// CAMs one behind the other, in the plan's order.
class DrawnBoard {
 public:
  /// Throws DesignError for a plan whose wires are wrong or loop. The plan must outlive it.
  DrawnBoard(const Plan& plan, std::vector<Hertz> grid);

  const std::vector<Hertz>& grid() const { return grid_; }
  std::size_t capacitor_count() const { return units_.size(); }
  /// As the plan has them.
  const std::vector<double>& nominal_units() const { return units_; }
  /// "chip1.Section1a.Ca".
  const std::vector<std::string>& names() const { return names_; }

  /// From the input pin to the output pin, at the grid.
  std::vector<std::complex<double>> response(std::span<const double> units) const;
  void response(std::span<const double> units, std::span<std::complex<double>> out) const;

  /// d ln H / d ln C of every capacitor: [capacitor][frequency].
  std::vector<std::vector<std::complex<double>>> sensitivities() const;
  std::vector<std::vector<std::complex<double>>> sensitivities(std::span<const double> units) const;

  /// What each CAM does from each of its inputs: [node of graph()][input, from 0][frequency], at its samples.
  using Transfers = std::vector<std::vector<std::vector<std::complex<double>>>>;
  Transfers transfers(std::span<const double> units) const;
  /// With every CAM's transfers as given (lines that clocks fold back are left out).
  std::vector<std::complex<double>> response(const Transfers& transfers) const;
  /// From the input pin to each CAM's output, and from there to the output pin: [node][frequency].
  std::vector<std::vector<std::complex<double>>> nodes(const Transfers& transfers) const;
  std::vector<std::vector<std::complex<double>>> onward(const Transfers& transfers) const;
  const PlanGraph& graph() const { return graph_; }

  /// The capacitors of one board.
  std::vector<double> drawn(const MismatchModel& mismatch, Random& random) const;

 private:
  struct Read {
    std::vector<std::complex<double>> factor;  ///< what reading makes of the source's held output
  };
  struct NodeOnGrid {
    std::size_t first_capacitor = 0;
    std::vector<Read> inputs;
    std::vector<std::complex<double>> d;  ///< 1 - 1/z
  };

  void prepare(std::size_t node);
  /// Lines that other clocks fold back are in it.
  void folded_response(std::span<const double> units, std::span<std::complex<double>> out) const;

  const Plan& plan_;
  PlanGraph graph_;
  std::vector<Hertz> grid_;
  std::vector<double> units_;
  std::vector<std::string> names_;
  std::vector<NodeOnGrid> on_grid_;                ///< of each node
  std::vector<std::complex<double>> output_hold_;  ///< of the CAM that drives the output pin
  bool folds_ = false;
};

/// What boards do with their capacitors drawn by the model, against the plan as it is designed.
struct MismatchSpread {
  int draws = 0;
  double median_percent = 0.0;  ///< worst complex change over the grid: median, 95 %, largest
  double p95_percent = 0.0;
  double max_percent = 0.0;
  double p95_db = 0.0;
  /// The capacitors that matter most, where the spread is largest: share of the variance, largest first.
  struct Share {
    std::string capacitor;
    double share = 0.0;
  };
  std::vector<Share> shares;

  /// Without the model; the first few capacitors.
  Json to_json() const;
};
MismatchSpread mismatch_spread(const DrawnBoard& board, const MismatchModel& mismatch, int draws,
                               std::uint64_t seed);

}  // namespace bodesmith::fpaa
