#pragma once

#include <string>

#include "base/documents/document.hpp"
#include "chain/model_file.hpp"

namespace bodesmith {

/// The chain of these blocks of a model.toml.
inline chain::Chain model_of(const std::string& blocks) {
  return chain::model_from_node(parse_toml("schema = \"bodesmith.model/1\"\n" + blocks, "model.toml"));
}

}  // namespace bodesmith
