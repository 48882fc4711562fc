#pragma once

#include "base/json_fwd.hpp"

namespace bodesmith::chain {

/// The JSON Schema (draft 2020-12) of model.toml: schemas/model.schema.json, made from the registry of block types.
Json model_schema();

}  // namespace bodesmith::chain
