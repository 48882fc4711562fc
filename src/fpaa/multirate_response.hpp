#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "base/units.hpp"
#include "fpaa/plan_graph.hpp"

namespace bodesmith::fpaa {

/// What a board with several clocks does to a sine at the sine's own frequency, exactly.
///
/// All clocks have an edge at t = 0. A CAM of period T that reads the held output of one of period S sees,
/// besides the sine, lines at multiples of 1/S: reading makes of a line of frequency phi the factor
///   exp(-2 pi j phi D) (1/P) sum_{k < P} exp(-2 pi j phi k g),   g = gcd(S, T), P = S/g,
/// D the delay of the CAM that is read, rounded up to a multiple of g (at a common edge a CAM reads what its
/// inputs have just become). Lines that a later clock folds back onto the sine are carried along: those whose
/// distance is a multiple of 1/gcd(lcm of all periods up to here, lcm of all periods from here on). At the
/// output pin the last output is held continuously (P without end: the zero-order hold).
class MultirateResponse {
 public:
  /// Throws DesignError where the wires are wrong, or loop through several CAMs.
  explicit MultirateResponse(const Plan& plan);

  std::complex<double> without_delays(RadPerSecond w) const;
  std::complex<double> as_it_runs(RadPerSecond w) const;

  /// From the input to each CAM's output, in the order of graph().nodes, at its own ticks (no hold of its own).
  std::vector<std::complex<double>> nodes_as_they_run(RadPerSecond w) const;
  const PlanGraph& graph() const { return graph_; }

 private:
  /// One line of one input: which line of the source becomes which line here, and how far it is from the sine.
  struct Passage {
    std::size_t input = 0;  ///< index into the node's inputs
    std::size_t source_line = 0;
    std::size_t line = 0;
    double distance = 0.0;  ///< in cycles a tick
  };
  struct NodeLines {
    std::vector<double> distance;  ///< of each line carried, in cycles a tick; the sine itself is line 0
    std::vector<Passage> passages;
    std::vector<double> common_ticks;  ///< of each input: g
    std::vector<double> delay_ticks;   ///< of each input: D, rounded up
  };
  using Lines = std::vector<std::vector<std::complex<double>>>;

  void find_lines();
  void find_passages(std::size_t node, const std::vector<std::int64_t>& fold);
  Lines lines_at(RadPerSecond w) const;

  PlanGraph graph_;
  std::vector<NodeLines> lines_;
};

}  // namespace bodesmith::fpaa
