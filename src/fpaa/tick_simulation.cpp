#include "fpaa/tick_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/error.hpp"

namespace bodesmith::fpaa {
namespace {

/// Least common period of all clocks, or nothing when it is longer than `limit` ticks.
std::optional<std::int64_t> common_period(const PlanGraph& graph, std::int64_t limit) {
  std::int64_t out = 1;
  for (const PlanGraph::PlanNode& node : graph.nodes) {
    const std::int64_t step = node.period / std::gcd(out, node.period);
    if (step > limit / out) return std::nullopt;
    out *= step;
  }
  return out;
}

/// The integral of exp(-j w t) from a to b, seconds.
std::complex<double> turning_integral(double w, double a, double b) {
  const double half = 0.5 * w * (b - a);
  const double sinc = std::abs(half) < 1e-8 ? 1.0 : std::sin(half) / half;
  return std::polar((b - a) * sinc, -0.5 * w * (a + b));
}

}  // namespace

TickSimulation::TickSimulation(const Plan& plan)
    : graph_(value_or_throw(plan_graph(plan))), states_(graph_.nodes.size()), next_(graph_.nodes.size(), 0) {
  for (std::size_t i = 0; i < graph_.nodes.size(); ++i)
    states_[i].inputs.resize(graph_.nodes[i].inputs.size());
}

double TickSimulation::next_edge_s() const {
  const auto next = std::min_element(next_.begin(), next_.end());
  if (next == next_.end()) return std::numeric_limits<double>::infinity();
  return static_cast<double>(*next) * tick_s();
}

double TickSimulation::newest(std::size_t node) const {
  return states_[node].outputs.empty() ? 0.0 : states_[node].outputs.front();
}

double TickSimulation::visible(std::size_t node, std::int64_t tick) const {
  const PlanGraph::PlanNode& what = graph_.nodes[node];
  const State& state = states_[node];
  // The newest sample k with k period + delay <= tick.
  const std::int64_t since = tick - what.delay;
  if (since < 0) return 0.0;
  const std::int64_t sample = since / what.period;
  const std::int64_t back = std::max<std::int64_t>(0, state.edges - 1 - sample);
  return static_cast<std::size_t>(back) < state.outputs.size() ? state.outputs[static_cast<std::size_t>(back)]
                                                               : 0.0;
}

double TickSimulation::source_v(const PlanGraph::Source& source, double input, std::int64_t tick) const {
  return source.node ? visible(*source.node, tick) : input;
}

/// a0 y[n] = sum over inputs and k of b_k x[n-k] - sum over k > 0 of a_k y[n-k].
void TickSimulation::compute(std::size_t node, double input) {
  const PlanGraph::PlanNode& what = graph_.nodes[node];
  State& state = states_[node];
  const std::vector<double>& below = what.cam->z.denominator;
  double sum = 0.0;
  for (std::size_t k = 0; k < what.inputs.size(); ++k) {
    const ZTransfer z = what.cam->z_from(what.inputs[k].number);
    const std::vector<double>& above = z.numerator;
    // x[n] of an input that acts only later may not be there yet (a loop): it is latched below.
    if (above[0] != 0.0) sum += above[0] * source_v(what.inputs[k].from, input, now_);
    for (std::size_t p = 1; p < above.size() && p <= state.inputs[k].size(); ++p) {
      sum += above[p] * state.inputs[k][p - 1];
    }
  }
  for (std::size_t p = 1; p < below.size() && p <= state.outputs.size(); ++p) {
    sum -= below[p] * state.outputs[p - 1];
  }
  state.outputs.push_front(sum / below[0]);
  ++state.edges;
  const auto kept =
      std::max<std::size_t>(below.size(), static_cast<std::size_t>(what.delay / what.period) + 3);
  if (state.outputs.size() > kept) state.outputs.pop_back();
}

double TickSimulation::step(const std::function<double(double)>& input) {
  if (next_.empty()) throw DesignError("the plan has no CAMs, there is nothing to simulate");
  now_ = *std::min_element(next_.begin(), next_.end());
  const double time = static_cast<double>(now_) * tick_s();
  input_v_ = input(time);
  for (const std::size_t i : graph_.order) {
    if (next_[i] == now_) compute(i, input_v_);
  }
  for (std::size_t i = 0; i < graph_.nodes.size(); ++i) {
    if (next_[i] != now_) continue;
    next_[i] += graph_.nodes[i].period;
    for (std::size_t k = 0; k < graph_.nodes[i].inputs.size(); ++k) {
      const PlanGraph::Input& wired = graph_.nodes[i].inputs[k];
      std::deque<double>& history = states_[i].inputs[k];
      history.push_front(source_v(wired.from, input_v_, now_));
      if (history.size() >= graph_.nodes[i].cam->z_from(wired.number).numerator.size()) history.pop_back();
    }
  }
  return time;
}

double TickSimulation::output_v() const {
  return graph_.output ? source_v(*graph_.output, input_v_, now_) : 0.0;
}

std::complex<double> TickSimulation::fundamental(const Plan& plan, Hertz f, double settle_s,
                                                 double window_s) {
  const double w = f.rad_s().value;
  TickSimulation real(plan);
  TickSimulation imaginary(plan);
  const PlanGraph& graph = real.graph();
  if (!graph.output || !graph.output->node) throw DesignError("no CAM drives the output pin");
  const std::size_t last = *graph.output->node;
  const std::int64_t period = graph.nodes[last].period;
  auto window =
      static_cast<std::int64_t>(std::ceil(window_s * graph.tick_rate / static_cast<double>(period)));
  if (const auto common = common_period(graph, std::int64_t{1} << 40)) {
    const std::int64_t share = *common / period;
    if (share <= 1000000) window = (window + share - 1) / share * share;
  }
  const auto settle =
      static_cast<std::int64_t>(std::ceil(settle_s * graph.tick_rate / static_cast<double>(period)));
  std::complex<double> sum = 0.0;
  const double held = static_cast<double>(period) * real.tick_s();
  const double delay = static_cast<double>(graph.nodes[last].delay) * real.tick_s();
  while (real.edges(last) < settle + window) {
    const std::int64_t before = real.edges(last);
    real.step([&](double t) { return std::cos(w * t); });
    imaginary.step([&](double t) { return std::sin(w * t); });
    if (real.edges(last) == before || before < settle) continue;
    const double from = static_cast<double>(before) * held + delay;
    sum += std::complex<double>(real.newest(last), imaginary.newest(last)) *
           turning_integral(w, from, from + held);
  }
  return sum / (static_cast<double>(window) * held);
}

}  // namespace bodesmith::fpaa
