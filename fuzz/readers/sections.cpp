#include "lti/sections.hpp"
#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_sections_bytes(std::string_view bytes) {
  const Sections sections = Sections::from_node(parse_json(bytes, "sections.json"));
  require_finite(sections.to_json());
}
const Registered sections_reader{"sections", read_sections_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
