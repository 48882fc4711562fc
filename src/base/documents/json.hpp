#pragma once

#include <nlohmann/json.hpp>

#include <string_view>

#include "base/documents/json_fwd.hpp"  // IWYU pragma: export
#include "base/provenance.hpp"

namespace bodesmith {
/// The beginning of every JSON output:
/// {"schema": "bodesmith.NAME/1", "program": "bodesmith VERSION", "inputs": [{"path", "sha256"}]}.
Json json_header(std::string_view name, const Provenance& from);
/// A whole one: the header, `body`, and the seconds of the work itself.
Json timed_json(std::string_view name, const Provenance& from, const Json& body, double seconds);

}  // namespace bodesmith
