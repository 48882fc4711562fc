#include "hysteresis/registry.hpp"

// Each function stands in the model's own file. A new model is one line here.
namespace bodesmith::hysteresis {

BODESMITH_REGISTRY(ModelType, model_type_registry, "hysteresis model", polynomial_hysteresis_type,
                   sine_hysteresis_type, exponential_operator_type, ellipse_type, fractional_dynamic_type,
                   krasnoselskii_pokrovskii_type, preisach_type, prandtl_ishlinskii_type, bouc_wen_type)

Model make_model(std::string_view type, const Parameters& values) {
  return model_type_registry().get(type).model(values);
}

}  // namespace bodesmith::hysteresis
