#include "faults/kinds/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace bodesmith::faults {
namespace {

/// How an op-amp takes a load at its output is known no better than the op-amp itself; between passive parts a load is one
/// more of them.
constexpr double kLoadModelError = 0.02;

bool is_driven(const CircuitBoard& board, const std::string& node) {
  const auto& opamps = board.circuit().opamps;
  return std::any_of(opamps.begin(), opamps.end(),
                     [&](const schematic::OpAmp& one) { return one.out == node; });
}

}  // namespace

std::vector<Fault> load_faults(const CircuitBoard& board, const Load& load) {
  std::vector<Fault> out;
  for (const std::string& node : board.nodes()) {
    const std::string where = node == "out" ? "the output" : "node " + node;
    Fault fault;
    fault.parts = {where};
    fault.site = where;
    fault.from = std::log(load.least);
    fault.to = std::log(load.most);
    fault.effect = [&board, node, stamp = load.stamp, driven = is_driven(board, node)](double t) {
      Effect effect;
      effect.stamps = {stamp(board, node, std::exp(t))};
      if (driven) {
        effect.model_error = kLoadModelError;
        effect.stamps[0].rough = true;
      }
      return effect;
    };
    fault.words = [where, unit = load.unit, end = load.words_end](double t) {
      return fmt::format("{} is loaded with {} to ground{}", where, engineering_text(std::exp(t), unit), end);
    };
    fault.size = [key = load.key](double t) { return FaultSize{key, std::exp(t)}; };
    fault.rework = load.rework(where);
    out.push_back(std::move(fault));
  }
  return out;
}

}  // namespace bodesmith::faults
