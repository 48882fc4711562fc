#include "identify/record_findings.hpp"

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "chain/registry.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::identify {
namespace {

Json figures_json(const ErrorFigures& figures) {
  return {{"rms", figures.rms},
          {"max", figures.max},
          {"range", figures.range},
          {"rms_percent_of_range", figures.rms_percent},
          {"max_percent_of_range", figures.max_percent},
          {"rms_free_offset", figures.rms_free_offset}};
}

}  // namespace

Json to_json(const StageFit& fit) {
  Json out;
  out["model"] = fit.model;
  if (!fit.refused.empty()) {
    out["refused"] = fit.refused;
    return out;
  }
  out["method"] = fit.identified.method;
  out["converged"] = fit.identified.converged;
  out["training"] = figures_json(fit.training);
  if (fit.holdout) out["holdout"] = figures_json(*fit.holdout);
  out["delay_s"] = fit.stage.delay_s;
  Json parameters = Json::array();
  for (const auto& one : fit.identified.uncertainty) {
    Json entry = {{"name", one.name}, {"value", one.value}};
    // A parameter that the record does not determine has no finite deviation.
    if (std::isfinite(one.standard_deviation)) entry["standard_deviation"] = one.standard_deviation;
    parameters.push_back(entry);
  }
  out["parameters"] = parameters;
  out["notes"] = fit.identified.notes;
  out["compute_s"] = fit.compute_s;
  return out;
}

namespace {

chain::Trained trained_of(const StageFit& fit, std::span<const TimeRecord> training, double skip_s) {
  chain::Trained out;
  out.input = input_extent(training, skip_s);
  const hysteresis::Range output = hysteresis::output_range(training, skip_s);
  out.output_lower = output.low;
  out.output_upper = output.high;
  out.training_rms = fit.training.rms;
  out.training_percent = fit.training.rms_percent;
  if (fit.holdout) {
    out.holdout_rms = fit.holdout->rms;
    out.holdout_percent = fit.holdout->rms_percent;
  }
  return out;
}

/// Whether the stage's size may be refitted (a delay alone does not let it).
bool has_free_gain(const chain::Chain& model) {
  return std::ranges::any_of(model.blocks, [](const chain::Block& block) {
    return std::ranges::any_of(block.parameters(),
                               [](const chain::Parameter& p) { return p.free && p.key() == "gain"; });
  });
}

}  // namespace

chain::Chain identified_model(const StageFit& fit, std::span<const TimeRecord> training, double skip_s) {
  chain::Chain model = fit.stage.chain();
  if (!has_free_gain(model)) {
    model.blocks.push_back(chain::make_block("gain").set("gain", 1.0).set("offset", 0.0));
    for (chain::Parameter& p : model.blocks.back().parameters()) p.free = true;
  }
  model.trained = trained_of(fit, training, skip_s);
  return model;
}

}  // namespace bodesmith::identify
