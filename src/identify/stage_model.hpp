#pragma once

#include <vector>

#include "chain/chain.hpp"
#include "hysteresis/model_type.hpp"

namespace bodesmith::identify {

/// What is identified and inverted: a hysteresis model (or none) between two scalings, with a pure delay,
///   y(t) = output(H[input(u)](t − delay)),
/// as a chain of blocks: gain, the model, gain, delay, those left out that do nothing.
struct StageModel {
  double delay_s = 0.0;
  hysteresis::Scaling input;
  hysteresis::Model model;  ///< without a type: H[u] = u
  hysteresis::Scaling output;

  StageModel() = default;
  StageModel(const hysteresis::Identified& found, double delay)
      : delay_s(delay), input(found.input), model(found.model), output(found.output) {}

  /// With the output's scaling and the delay free, and at rest under the first input.
  chain::Chain chain() const;

  /// The output for every sample, starting at rest under the first input. The input is linear between
  /// samples.
  std::vector<double> simulate(const std::vector<double>& u, double step_s) const;
};

}  // namespace bodesmith::identify
