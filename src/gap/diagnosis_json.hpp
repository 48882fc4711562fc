#pragma once

#include "base/documents/json_fwd.hpp"
#include "gap/diagnosis.hpp"

namespace bodesmith::gap {

/// diagnosis.json without its header.
Json to_json(const Diagnosis& diagnosis);

}  // namespace bodesmith::gap
