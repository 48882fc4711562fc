#include "fpaa/plan/switched_board.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
SwitchedBoard::SwitchedBoard(const Plan& plan, bool with_noise)
    : graph_(value_or_throw(plan_graph(plan))), slow_(plan.slow), networks_(graph_.tick_rate) {
  if (graph_.looped) {
    throw DesignError("the plan's wires loop, which has no response of this kind: simulate it instead");
  }
  std::vector<std::size_t> inputs;
  for (const PlanGraph::PlanNode& node : graph_.nodes) {
    first_capacitor_.push_back(units_.size());
    for (const Capacitor& c : node.cam->capacitors) {
      units_.push_back(c.units);
      names_.push_back(node.name + "." + c.name);
    }
    const StageSwitches stage = switches_of(*node.cam, node.name);
    inputs.push_back(static_cast<std::size_t>(stage.inputs()));
    counted_.emplace_back(circuit_of(stage, plan.slow));
  }
  network_of_.assign(graph_.nodes.size(), 0);
  for (const std::size_t n : graph_.order) {
    using Source = PeriodicNetworks::Source;
    std::vector<Source> sources(inputs[n]);
    for (const PlanGraph::Input& input : graph_.nodes[n].inputs) {
      if (input.number > sources.size()) continue;
      sources[input.number - 1] = input.from.node
                                      ? Source{Source::Kind::network, network_of_[*input.from.node]}
                                      : Source{Source::Kind::board_input, 0};
    }
    network_of_[n] = networks_.add(clocked(n, units_, with_noise), std::move(sources));
  }
  if (graph_.output.node) networks_.set_output(network_of_[*graph_.output.node]);
}

ClockedNetwork SwitchedBoard::clocked(std::size_t n, std::span<const double> units, bool with_noise) const {
  const PlacedCam& cam = *graph_.nodes[n].cam;
  const CapacitorUnits own(cam.capacitors, units.subspan(first_capacitor_[n], cam.capacitors.size()));
  const StageSwitches stage = *cam.cam->switches(cam, own);
  // Another draw has other sizes alone.
  SwitchedNetwork network = counted_[n];
  std::size_t at = 0;
  for (const StageCapacitor& c : stage.capacitors) {
    if (c.units > 0.0 && at++ < network.capacitors.size()) network.capacitors[at - 1].size = c.units;
  }
  if (at != network.capacitors.size()) network = circuit_of(stage, slow_);
  return ClockedNetwork(network, {graph_.nodes[n].period}, with_noise);
}

Hertz SwitchedBoard::fastest_clock() const {
  Hertz out{0.0};
  for (const PlanGraph::PlanNode& node : graph_.nodes) out = std::max(out, node.cam->clock_a);
  return out;
}

Complex SwitchedBoard::sampled(RadPerSecond w) const {
  if (!graph_.output.node) return 1.0;
  std::vector<Complex> out(graph_.nodes.size(), 0.0);
  for (const std::size_t i : graph_.order) {
    const PlanGraph::PlanNode& node = graph_.nodes[i];
    for (const PlanGraph::Input& input : node.inputs) {
      const Complex source = input.from.node ? out[*input.from.node] : 1.0;
      out[i] += node.cam->z.response(w, node.cam->clock_a, input.number) * source;
    }
  }
  return out[*graph_.output.node];
}

void SwitchedBoard::set_units(std::span<const double> units) {
  for (std::size_t n = 0; n < graph_.nodes.size(); ++n) {
    const std::size_t first = first_capacitor_[n];
    const std::size_t count = graph_.nodes[n].cam->capacitors.size();
    const std::span<const double> old = drawn_.empty() ? std::span<const double>(units_) : drawn_;
    // Only what changed: a search or a derivative moves one capacitor at a time.
    if (std::equal(units.begin() + static_cast<std::ptrdiff_t>(first),
                   units.begin() + static_cast<std::ptrdiff_t>(first + count),
                   old.begin() + static_cast<std::ptrdiff_t>(first)))
      continue;
    networks_.replace(network_of_[n], clocked(n, units, false));
  }
  drawn_.assign(units.begin(), units.end());
}

std::vector<std::vector<PeriodicNetworks::NodeSize>> SwitchedBoard::nodes(RadPerSecond w) const {
  auto sizes = networks_.nodes(w);
  std::vector<std::vector<PeriodicNetworks::NodeSize>> out(sizes.size());
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = std::move(sizes[network_of_[n]]);
  return out;
}

std::vector<double> SwitchedBoard::noise_density(RadPerSecond w) const {
  const std::vector<double> densities = networks_.noise_density(w);
  std::vector<double> out;
  for (const std::size_t network : network_of_) out.push_back(densities[network]);
  return out;
}

}  // namespace bodesmith::fpaa
