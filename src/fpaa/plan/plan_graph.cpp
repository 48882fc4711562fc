#include "fpaa/plan/plan_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// Builds the graph; each step throws DesignError where it cannot.
class GraphBuilder {
 public:
  explicit GraphBuilder(const Plan& plan) : plan_(plan) {}

  PlanGraph build() {
    out_.tick_rate = ticks_per_second(board_by_name(plan_.board));
    add_nodes();
    sort_wires();
    for (const Wire& wire : plan_.wires) connect(wire);
    const std::string pin = plan_.output_pin();
    if (pin.empty()) throw DesignError("no wire leads to an output pin, expected one");
    out_.output = source(pin);
    find_order();
    return std::move(out_);
  }

 private:
  void add_nodes() {
    for (const ChipPlan& chip : plan_.chips) {
      for (const PlacedCam& cam : chip.cams) {
        PlanGraph::PlanNode node;
        node.cam = &cam;
        node.name = fmt::format("chip{}.{}", chip.chip, cam.name);
        node.chip = chip.chip;
        node.period = std::max<std::int64_t>(1, nearest_whole<long long>(out_.tick_rate / cam.clock_a.value));
        node.delay = nearest_whole<long long>(cam.delay_cycles * static_cast<double>(node.period));
        node_of_[node.name] = out_.nodes.size();
        out_.nodes.push_back(std::move(node));
      }
    }
  }

  /// Pins by what drives them.
  void sort_wires() {
    for (const Wire& wire : plan_.wires) {
      for (const std::string& end : {wire.from, wire.to}) {
        if (node_of_.count(end) == 0 && !WireEnd(end).is_input_pin() && !WireEnd(end).is_output_pin()) {
          throw DesignError(
              fmt::format("a wire ends at '{}', expected a CAM of the plan or a pin (chip1.in1)", end));
        }
      }
      if (node_of_.count(wire.to) != 0) continue;
      if (!driver_of_pin_.emplace(wire.to, wire.from).second) {
        throw DesignError(fmt::format("two wires lead to {}, expected one", wire.to));
      }
    }
  }

  PlanGraph::Source source(std::string name) const {
    for (std::size_t hops = 0; hops <= plan_.wires.size(); ++hops) {
      if (const auto node = node_of_.find(name); node != node_of_.end()) {
        return {node->second};
      }
      const auto driver = driver_of_pin_.find(name);
      if (driver == driver_of_pin_.end()) {
        if (WireEnd(name).is_input_pin()) return {};
        throw DesignError(fmt::format("nothing is wired to {}, which other wires start from", name));
      }
      name = driver->second;
    }
    throw DesignError(fmt::format("the pins at {} are wired in a circle", name));
  }

  void connect(const Wire& wire) {
    const auto to = node_of_.find(wire.to);
    if (to == node_of_.end()) return;
    PlanGraph::PlanNode& node = out_.nodes[to->second];
    const auto number = static_cast<std::size_t>(wire.input);
    if (wire.input < 1 || number > node.cam->input_count()) {
      throw DesignError(fmt::format("a wire leads to input {} of {}, which has {}", wire.input, wire.to,
                                    node.cam->input_count()));
    }
    for (const PlanGraph::Input& input : node.inputs) {
      if (input.number == number) {
        throw DesignError(fmt::format("two wires lead to input {} of {}, expected one", wire.input, wire.to));
      }
    }
    node.inputs.push_back({number, source(wire.from)});
  }

  /// Whether this input acts on the output at the same edge.
  static bool at_once(const PlanGraph::PlanNode& node, const PlanGraph::Input& input) {
    return node.cam->z.numerators[input.number - 1][0] != 0.0 && node.delay == 0;
  }

  void find_order() {
    std::vector<bool> done(out_.nodes.size(), false);
    while (out_.order.size() < out_.nodes.size()) {
      const std::size_t before = out_.order.size();
      // First those that read only what is settled; if there are none, one that reads late.
      for (const bool late : {false, true}) {
        for (std::size_t i = 0; i < out_.nodes.size() && out_.order.size() == before; ++i) {
          if (done[i] || !is_ready(i, done, late)) continue;
          done[i] = true;
          out_.order.push_back(i);
          out_.looped = out_.looped || late;
        }
      }
      if (out_.order.size() == before) {
        throw DesignError(
            "the wires make a loop without any delay, expected a CAM in it that reads one period late");
      }
    }
  }

  bool is_ready(std::size_t i, const std::vector<bool>& done, bool late) const {
    const PlanGraph::PlanNode& node = out_.nodes[i];
    return std::ranges::all_of(node.inputs, [&](const PlanGraph::Input& input) {
      return !input.from.node || done[*input.from.node] || (late && !at_once(node, input));
    });
  }

  const Plan& plan_;
  PlanGraph out_;
  std::map<std::string, std::size_t> node_of_;
  std::map<std::string, std::string> driver_of_pin_;
};

}  // namespace

double ticks_per_second(const Board& board) {
  return 2.0 * board.master_clock.value;
}

StageSwitches switches_of(const PlacedCam& cam, const std::string& name) {
  auto stage = cam.cam->switches(cam);
  if (!stage) {
    throw DesignError(
        fmt::format("the switches of {} ({}) are not known, expected only CAMs made of switched capacitors",
                    name, cam.cam_name()));
  }
  return *std::move(stage);
}

Outcome<PlanGraph> plan_graph(const Plan& plan) {
  try {
    return GraphBuilder(plan).build();
  } catch (const DesignError& refused) {
    return Refusal{refused.what()};
  }
}

}  // namespace bodesmith::fpaa
