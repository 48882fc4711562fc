#include "hysteresis/registry.hpp"

#include "base/progress.hpp"

// Each function stands in the model's own file. A new model is one line here.
namespace bodesmith::hysteresis {

BODESMITH_REGISTRY(ModelType, model_type_registry, "hysteresis model", polynomial_hysteresis_type,
                   sine_hysteresis_type, exponential_operator_type, ellipse_type, fractional_dynamic_type,
                   krasnoselskii_pokrovskii_type, preisach_type, prandtl_ishlinskii_type, bouc_wen_type)

Model make_model(std::string_view type, const Parameters& values) {
  return model_type_registry().get(type).model(values);
}

Identified ModelType::identify(std::span<const TimeRecord> records, const IdentifyOptions& options) const {
  for (const TimeRecord& record : records) record.require_measured_sizes();
  const Stopwatch watch;
  Identified out = fit(records, options);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace bodesmith::hysteresis
