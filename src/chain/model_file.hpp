#pragma once

#include <filesystem>
#include <string>

#include "base/documents/document.hpp"
#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "chain/chain.hpp"

namespace bodesmith::chain {

/// model.toml (schema bodesmith.model/1; JSON of the same shape works too). Refused with file and line: an
/// unknown type or key, a missing or out-of-bounds value, a name in `free` that is not a parameter of its
/// block. An optional table [trained] says what the model was fitted to (chain/chain.hpp). A sections.json is a model too
/// (chain/sections_chain.hpp).
Chain read_model(const std::filesystem::path& path, Provenance& from);
Chain model_from_node(const Node& node);
/// One block, from a table that has `type`.
Block block_from_node(const Node& node);

/// The text of a model.toml that reads back as the same chain; `comment` stands at its top, line by line
/// after #.
std::string model_text(const Chain& chain, const std::string& comment = {});

/// The JSON Schema (draft 2020-12) of model.toml: schemas/model.schema.json, made from the registry of block types.
Json model_schema();

}  // namespace bodesmith::chain
