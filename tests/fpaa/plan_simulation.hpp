#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/board.hpp"
#include "fpaa/cam_simulation.hpp"
#include "fpaa/plan_graph.hpp"

namespace bodesmith::fpaa {

/// A plan run edge by edge (CamSimulation), wired as it says: nothing but difference equations, samples and
/// holds. All clocks have an edge at t = 0; at a common edge a CAM reads what its inputs have just become.
class PlanSimulation {
 public:
  /// `input` gives volts at the input pin at a time in seconds; the boards clip at 3 V.
  PlanSimulation(const Plan& plan, std::function<double(double)> input)
      : graph_(value_or_throw(plan_graph(plan))),
        output_(graph_.output && graph_.output->node ? graph_.nodes[*graph_.output->node].name : "in"),
        board_(cells(), parts(std::move(input)), board_by_name(plan.board)) {}

  const PlanGraph& graph() const { return graph_; }
  double tick_s() const { return 1.0 / graph_.tick_rate; }
  /// The output pin, right after everything that happens at this tick.
  double output_v(std::int64_t tick) {
    board_.advance_to((static_cast<double>(tick) + 0.25) * tick_s());
    return board_.value(output_);
  }

 private:
  std::vector<CamSimulation::Cell> cells() const {
    std::vector<CamSimulation::Cell> out;
    for (const PlanGraph::PlanNode& node : graph_.nodes) {
      CamSimulation::Cell cell{*node.cam, std::vector<std::string>(node.cam->input_count(), "nothing"), {}};
      cell.cam.name = node.name;
      cell.cam.phase = 1;
      for (const PlanGraph::Input& input : node.inputs) {
        cell.inputs[input.number - 1] = input.from.node ? graph_.nodes[*input.from.node].name : "in";
      }
      out.push_back(std::move(cell));
    }
    return out;
  }
  static std::vector<CamSimulation::Part> parts(std::function<double(double)> input) {
    return {{"in", {}, [input = std::move(input)](double t, std::span<const double>) { return input(t); }},
            {"nothing", {}, [](double, std::span<const double>) { return 0.0; }}};
  }

  PlanGraph graph_;
  std::string output_;
  CamSimulation board_;
};

/// Least common period of all clocks, or nothing when it is longer than `limit` ticks.
inline std::optional<std::int64_t> common_period(const PlanGraph& graph, std::int64_t limit) {
  std::int64_t out = 1;
  for (const PlanGraph::PlanNode& node : graph.nodes) {
    const std::int64_t step = node.period / std::gcd(out, node.period);
    if (step > limit / out) return std::nullopt;
    out *= step;
  }
  return out;
}

/// What comes out at the sine's own frequency: the plan run for cos and sin, the last output times
/// exp(-j w t) averaged over a window after `settle_s` (each held value integrated exactly). The window is
/// at least `window_s`, and whole common periods of all clocks where those are shorter: the average is then
/// exact, whatever the frequency.
inline std::complex<double> simulated_fundamental(const Plan& plan, Hertz f, double settle_s,
                                                  double window_s) {
  constexpr double kAmplitude = 1e-3;  // nothing clips
  const double w = f.rad_s().value;
  PlanSimulation real(plan, [w](double t) { return kAmplitude * std::cos(w * t); });
  PlanSimulation imaginary(plan, [w](double t) { return kAmplitude * std::sin(w * t); });
  const PlanGraph& graph = real.graph();
  if (!graph.output || !graph.output->node) throw DesignError("no CAM drives the output pin");
  const PlanGraph::PlanNode& last = graph.nodes[*graph.output->node];
  const auto edges = [&](double seconds) {
    return static_cast<std::int64_t>(std::ceil(seconds * graph.tick_rate / static_cast<double>(last.period)));
  };
  std::int64_t window = edges(window_s);
  if (const auto common = common_period(graph, std::int64_t{1} << 40)) {
    const std::int64_t share = *common / last.period;
    if (share <= 1000000) window = (window + share - 1) / share * share;
  }
  // The integral of exp(-j w t) over one held value.
  const double held = static_cast<double>(last.period) * real.tick_s();
  const double half = 0.5 * w * held;
  const double sinc = std::abs(half) < 1e-8 ? 1.0 : std::sin(half) / half;
  std::complex<double> sum = 0.0;
  const std::int64_t settle = edges(settle_s);
  for (std::int64_t n = settle; n < settle + window; ++n) {
    const std::int64_t tick = n * last.period + last.delay;
    const double from = static_cast<double>(tick) * real.tick_s();
    sum += std::complex<double>(real.output_v(tick), imaginary.output_v(tick)) * sinc *
           std::polar(1.0, -w * from - half);
  }
  return sum / (static_cast<double>(window) * kAmplitude);
}

}  // namespace bodesmith::fpaa
