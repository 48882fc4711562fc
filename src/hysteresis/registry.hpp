#pragma once

#include <string_view>

#include "base/registry.hpp"
#include "hysteresis/identification.hpp"
#include "hysteresis/model_type.hpp"

namespace bodesmith::hysteresis {

/// All types, in the order of the contract.
Registry<ModelType>& model_type_registry();

/// A model of the type of that name. InputError for an unknown name, DesignError for values that do not fit.
Model make_model(std::string_view type, const Parameters& values);

}  // namespace bodesmith::hysteresis
