#pragma once

#include <string>
#include <vector>

namespace bodesmith::cli {

/// One JSON Schema of schemas/.
struct SchemaFile {
  std::string name;  ///< "project": of bodesmith.project/1
  std::string file;  ///< "project.schema.json"
  std::string text;
};

/// All of them; that of model.toml as the registry of block types has it now.
std::vector<SchemaFile> schema_files();

}  // namespace bodesmith::cli
