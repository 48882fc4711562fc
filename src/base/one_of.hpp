#pragma once

#include <string>

#include "base/document.hpp"

namespace bodesmith {

/// The one of these values whose to_string() the node holds, or an error that lists them.
template <class Enum, class... Enums>
Enum one_of(const Node& node, Enum first, Enums... others) {
  const std::string word = node.one_of({to_string(first), to_string(others)...});
  Enum found = first;
  ((to_string(others) == word ? void(found = others) : void()), ...);
  return found;
}

}  // namespace bodesmith
