#pragma once

#include <string>
#include <vector>

namespace bodesmith::chain {

/// The keys that a table [trained] of model.toml has to have.
std::vector<std::string> needed_trained_keys();

}  // namespace bodesmith::chain
