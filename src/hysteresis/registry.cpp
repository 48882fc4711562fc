#include "hysteresis/registry.hpp"

// Each function stands in the model's own file. A new model is one line here.
#define BODESMITH_HYSTERESIS_MODELS(ENTRY) \
  ENTRY(polynomial_hysteresis_type)        \
  ENTRY(sine_hysteresis_type)              \
  ENTRY(exponential_operator_type)         \
  ENTRY(ellipse_type)                      \
  ENTRY(fractional_dynamic_type)           \
  ENTRY(krasnoselskii_pokrovskii_type)     \
  ENTRY(preisach_type)                     \
  ENTRY(prandtl_ishlinskii_type)           \
  ENTRY(bouc_wen_type)

namespace bodesmith::hysteresis {

#define BODESMITH_DECLARE(function) const ModelType& function();
BODESMITH_HYSTERESIS_MODELS(BODESMITH_DECLARE)
#undef BODESMITH_DECLARE

Registry<ModelType>& model_type_registry() {
#define BODESMITH_ADDRESS(function) &function(),
  static Registry<ModelType> registry("hysteresis model", {BODESMITH_HYSTERESIS_MODELS(BODESMITH_ADDRESS)});
#undef BODESMITH_ADDRESS
  return registry;
}

Model make_model(std::string_view type, const Parameters& values) {
  return model_type_registry().get(type).model(values);
}

}  // namespace bodesmith::hysteresis

#undef BODESMITH_HYSTERESIS_MODELS
