#include "fpaa/multirate_response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/error.hpp"
#include "fpaa/clocked_factors.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using GraphNode = PlanGraph::PlanNode;

/// Lines carried at one CAM; beyond it (clocks with hardly a common divisor, several deep) only the sine: each
/// line is then smaller than the reciprocal of this.
constexpr std::int64_t kMaxLines = 50000;

/// Least common multiple; 0, which stands for "too large to count", is kept.
std::int64_t common_multiple(std::int64_t a, std::int64_t b) {
  if (a == 0 || b == 0) return 0;
  const std::int64_t step = b / std::gcd(a, b);
  if (step > std::numeric_limits<std::int64_t>::max() / a) return 0;
  return a * step;
}

}  // namespace

MultirateResponse::MultirateResponse(const Plan& plan) : graph_(value_or_throw(plan_graph(plan))) {
  if (graph_.looped) {
    throw DesignError("the plan's wires loop, which has no response of this kind: simulate it instead");
  }
  find_lines();
}

void MultirateResponse::find_lines() {
  const std::vector<GraphNode>& nodes = graph_.nodes;
  std::vector<std::int64_t> up(nodes.size());
  std::vector<std::int64_t> down(nodes.size());
  for (const std::size_t i : graph_.order) {
    up[i] = nodes[i].period;
    for (const PlanGraph::Input& input : nodes[i].inputs) {
      if (input.from.node) up[i] = common_multiple(up[i], up[*input.from.node]);
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) down[i] = nodes[i].period;
  for (auto at = graph_.order.rbegin(); at != graph_.order.rend(); ++at) {
    for (const PlanGraph::Input& input : nodes[*at].inputs) {
      if (!input.from.node) continue;
      std::int64_t& source = down[*input.from.node];
      source = common_multiple(source, down[*at]);
    }
  }
  std::vector<std::int64_t> fold(nodes.size());
  lines_.resize(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::int64_t period = nodes[i].period;
    fold[i] = up[i] == 0 || down[i] == 0 ? period : std::gcd(up[i], down[i]);
    if (fold[i] / period > kMaxLines) fold[i] = period;
    for (std::int64_t m = 0; m < fold[i] / period; ++m) {
      lines_[i].distance.push_back(static_cast<double>(m) / static_cast<double>(fold[i]));
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) find_passages(i, fold);
}

void MultirateResponse::find_passages(std::size_t node, const std::vector<std::int64_t>& fold) {
  const GraphNode& reader = graph_.nodes[node];
  NodeLines& lines = lines_[node];
  for (std::size_t k = 0; k < reader.inputs.size(); ++k) {
    lines.common_ticks.push_back(0.0);
    lines.delay_ticks.push_back(0.0);
    if (!reader.inputs[k].from.node) continue;
    const std::size_t from = *reader.inputs[k].from.node;
    const GraphNode& source = graph_.nodes[from];
    const std::int64_t g = std::gcd(source.period, reader.period);
    lines.common_ticks.back() = static_cast<double>(g);
    lines.delay_ticks.back() = static_cast<double>((source.delay + g - 1) / g * g);
    const std::int64_t per_reader = fold[node] / reader.period;
    const std::int64_t per_source = fold[from] / source.period;
    for (std::int64_t m = 0; m < per_reader; ++m) {
      // Frequencies phi = (m + q per_reader)/fold, q < Q, are this line here; each is some line of the source.
      for (std::int64_t q = 0; q < reader.period / g; ++q) {
        const std::int64_t above = m + q * per_reader;  // phi fold[node]
        const std::int64_t shared = std::gcd(fold[node], fold[from]);
        if (above % (fold[node] / shared) != 0) continue;
        const std::int64_t own = above / (fold[node] / shared) * (fold[from] / shared);  // phi fold[from]
        lines.passages.push_back({k, static_cast<std::size_t>(own % per_source), static_cast<std::size_t>(m),
                                  static_cast<double>(above) / static_cast<double>(fold[node])});
      }
    }
  }
}

MultirateResponse::Lines MultirateResponse::lines_at(RadPerSecond w) const {
  const double frequency = w.hz().value / graph_.tick_rate;  // cycles a tick
  const double turn = 2.0 * std::numbers::pi;
  Lines out(graph_.nodes.size());
  for (const std::size_t i : graph_.order) {
    const GraphNode& node = graph_.nodes[i];
    const NodeLines& lines = lines_[i];
    const std::size_t count = lines.distance.size();
    out[i].assign(count, 0.0);
    std::vector<std::vector<Complex>> read(node.inputs.size(), std::vector<Complex>(count, 0.0));
    for (std::size_t k = 0; k < node.inputs.size(); ++k) {
      if (!node.inputs[k].from.node) read[k][0] = 1.0;
    }
    for (const Passage& passage : lines.passages) {
      const std::size_t from = *node.inputs[passage.input].from.node;
      const double g = lines.common_ticks[passage.input];
      const double phi = frequency + passage.distance;
      const double periods = static_cast<double>(graph_.nodes[from].period) / g;
      // Delays are multiples of g: whole turns of the distance over g are taken out before they cost digits.
      const double angle = turn * phi * g;
      const Complex delay = std::polar(1.0, -turn * std::fmod(phi * lines.delay_ticks[passage.input], 1.0));
      read[passage.input][passage.line] +=
          out[from][passage.source_line] * delay * mean_factor(periods, 0.5 * angle);
    }
    for (std::size_t line = 0; line < count; ++line) {
      const RadPerSecond at{w.value + turn * lines.distance[line] * graph_.tick_rate};
      const Hertz clock{graph_.tick_rate / static_cast<double>(node.period)};
      for (std::size_t k = 0; k < node.inputs.size(); ++k) {
        if (read[k][line] == 0.0) continue;
        out[i][line] += node.cam->z_from(node.inputs[k].number).response(at, clock) * read[k][line];
      }
    }
  }
  return out;
}

std::vector<Complex> MultirateResponse::nodes_as_they_run(RadPerSecond w) const {
  std::vector<Complex> out;
  for (const std::vector<Complex>& lines : lines_at(w)) out.push_back(lines[0]);
  return out;
}

Complex MultirateResponse::as_it_runs(RadPerSecond w) const {
  if (!graph_.output) return 0.0;
  if (!graph_.output->node) return 1.0;
  const std::size_t last = *graph_.output->node;
  const GraphNode& node = graph_.nodes[last];
  const Hertz clock{graph_.tick_rate / static_cast<double>(node.period)};
  const double delay = static_cast<double>(node.delay) / static_cast<double>(node.period);
  return lines_at(w)[last][0] * cycle_delay(w, clock, delay) * zero_order_hold(w, clock);
}

Complex MultirateResponse::without_delays(RadPerSecond w) const {
  if (!graph_.output) return 0.0;
  if (!graph_.output->node) return 1.0;
  std::vector<Complex> out(graph_.nodes.size(), 0.0);
  for (const std::size_t i : graph_.order) {
    const GraphNode& node = graph_.nodes[i];
    for (const PlanGraph::Input& input : node.inputs) {
      const Complex source = input.from.node ? out[*input.from.node] : 1.0;
      out[i] += node.cam->z_from(input.number).response(w, node.cam->clock_a) * source;
    }
  }
  return out[*graph_.output->node];
}

}  // namespace bodesmith::fpaa
