#include "base/documents/document.hpp"
#include "chain/model_file.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_model_bytes(std::string_view bytes) {
  const chain::Chain model = chain::model_from_node(parse_toml(bytes, "model.toml"));
  for (const chain::Block& block : model.blocks) {
    for (const auto& parameter : block.parameters()) require_finite(parameter.value);
  }
}
const Registered model_reader{"model", read_model_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
