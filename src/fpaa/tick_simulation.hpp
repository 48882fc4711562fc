#pragma once

#include <complex>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "fpaa/plan_graph.hpp"

namespace bodesmith::fpaa {

/// A plan run edge by edge, straight from the difference equations of its CAMs: nothing but samples and holds.
/// All clocks have an edge at t = 0; at a common edge a CAM reads what its inputs have just become; an output
/// is held for a period of its clock, `delay_cycles` later. All states are zero before the first edge. Wires
/// may loop where some CAM in the loop reads late.
class TickSimulation {
 public:
  /// The plan must outlive it. Throws DesignError where the wires are wrong.
  explicit TickSimulation(const Plan& plan);

  /// One edge of one or more clocks: the next one in time. `input` gives volts at the input pin at a time in
  /// seconds. Returns the time of the edge.
  double step(const std::function<double(double)>& input);
  /// Time of the next edge, seconds.
  double next_edge_s() const;

  /// Volts at the output pin and at each CAM's output (order of graph().nodes), right after the last edge.
  double output_v() const;
  double node_v(std::size_t node) const { return visible(node, now_); }
  const PlanGraph& graph() const { return graph_; }
  double tick_s() const { return 1.0 / graph_.tick_rate; }
  /// The node's newest sample, which stands at its output `delay_cycles` later, and how many edges it had.
  double newest(std::size_t node) const;
  std::int64_t edges(std::size_t node) const { return states_[node].edges; }

  /// What comes out at the sine's own frequency: the plan run for cos and sin, the last output times
  /// exp(-j w t) averaged over a window after `settle_s` (each held value integrated exactly). The window is
  /// at least `window_s`, and whole common periods of all clocks where those are shorter: the average is then
  /// exact, whatever the frequency.
  static std::complex<double> fundamental(const Plan& plan, Hertz f, double settle_s, double window_s);

 private:
  struct State {
    std::vector<std::deque<double>> inputs;  ///< of each wired input, newest first
    std::deque<double> outputs;              ///< newest first: y[n], y[n-1], …
    std::int64_t edges = 0;                  ///< how many there were
  };

  double visible(std::size_t node, std::int64_t tick) const;
  double source_v(const PlanGraph::Source& source, double input, std::int64_t tick) const;
  void compute(std::size_t node, double input);

  PlanGraph graph_;
  std::vector<State> states_;
  std::int64_t now_ = -1;
  std::vector<std::int64_t> next_;  ///< edge of each node, ticks
  double input_v_ = 0.0;
};

}  // namespace bodesmith::fpaa
