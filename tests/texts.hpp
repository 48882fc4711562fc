#pragma once

#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"

namespace bodesmith {

// What many tests do with texts. It costs the compiler a second or two wherever it is spelt out: std::regex, and JSON's parser.

/// Every match of an ECMAScript expression: itself and its groups.
std::vector<std::vector<std::string>> matches(const std::string& text, const std::string& pattern);
bool has_match(const std::string& text, const std::string& pattern);
/// `with`: $1 is the first group.
std::string replaced(const std::string& text, const std::string& pattern, const std::string& with);

Json parsed(const std::string& text);

}  // namespace bodesmith

namespace nlohmann {
/// For GoogleTest, which would write it as a container of containers.
void PrintTo(const bodesmith::Json& value, std::ostream* out);
}  // namespace nlohmann
