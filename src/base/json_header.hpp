#pragma once

#include <string_view>

#include "base/json_fwd.hpp"
#include "base/provenance.hpp"

namespace bodesmith {

/// The beginning of every JSON output:
/// {"schema": "bodesmith.NAME/1", "program": "bodesmith VERSION", "inputs": [{"path", "sha256"}]}.
Json json_header(std::string_view name, const Provenance& from);

}  // namespace bodesmith
