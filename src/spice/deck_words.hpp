#pragma once

#include <string>
#include <string_view>

namespace bodesmith::spice {

/// SPICE does not tell capitals from small letters.
std::string lower_case(std::string_view text);

}  // namespace bodesmith::spice
