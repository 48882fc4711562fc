#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace bodesmith {

/// JSON that keeps the order in which keys were written (for writing; reading goes through Node,
/// document.hpp). Headers need no more than this; where values are built, include base/documents/json.hpp.
using Json = nlohmann::ordered_json;

/// Text of a JSON document: two-space indent, short arrays of numbers on one line, a newline at the end.
/// Throws std::logic_error when a number is not finite: nothing may be silently NaN.
std::string to_text(const Json& value);

}  // namespace bodesmith
