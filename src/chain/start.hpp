#pragma once

#include <string_view>

namespace bodesmith::chain {

/// The state of a chain before the first sample.
enum class Start {
  zero,         ///< every state is zero
  equilibrium,  ///< at rest under the first input
};
/// "zero", "equilibrium".
constexpr std::string_view to_string(Start start) {
  return start == Start::equilibrium ? "equilibrium" : "zero";
}

}  // namespace bodesmith::chain
