#include "identify/stage_model.hpp"

#include <algorithm>

#include "base/documents/document.hpp"
#include "chain/blocks/hysteresis.hpp"
#include "chain/registry.hpp"

namespace bodesmith::identify {
namespace {

using hysteresis::Scaling;

bool does_nothing(const Scaling& scaling) {
  return scaling.gain == 1.0 && scaling.offset == 0.0;
}

chain::Block gain_block(const Scaling& scaling) {
  return chain::make_block("gain").set("gain", scaling.gain).set("offset", scaling.offset);
}

}  // namespace

chain::Chain StageModel::chain() const {
  chain::Chain out;
  out.start = chain::Start::equilibrium;  // as simulate() does
  if (!does_nothing(input)) out.blocks.push_back(gain_block(input));
  if (model.type != nullptr) out.blocks.push_back(chain::hysteresis_block(model));
  if (!does_nothing(output)) {
    out.blocks.push_back(gain_block(output));
    for (chain::Parameter& p : out.blocks.back().parameters()) p.free = true;
  }
  if (delay_s != 0.0) {
    out.blocks.push_back(chain::make_block("delay").set("delay_s", delay_s));
    for (chain::Parameter& p : out.blocks.back().parameters()) p.free = true;
  }
  return out;
}

std::vector<double> StageModel::simulate(const std::vector<double>& u, double step_s) const {
  if (u.empty()) return {};
  std::vector<double> y(u.size());
  if (model.type == nullptr) {
    for (std::size_t i = 0; i < u.size(); ++i) y[i] = output(input(u[i]));
    return later_by(y, delay_s / step_s);
  }
  const std::unique_ptr<hysteresis::Operator> hysteresis = make_operator(model);
  y[0] = output(hysteresis->reset(input(u[0])));
  for (std::size_t i = 1; i < u.size(); ++i) y[i] = output(hysteresis->step(input(u[i]), step_s));
  // A delay commutes with everything time-invariant; behind the operator it leaves the turning points where
  // the samples are.
  return later_by(y, delay_s / step_s);
}

}  // namespace bodesmith::identify
