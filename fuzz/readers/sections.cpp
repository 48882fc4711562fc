#include "lti/sections.hpp"
#include "base/document.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_sections_bytes(std::string_view bytes) {
  const Sections sections = Sections::from_node(parse_json(bytes, "sections.json"));
  require_finite(sections.gain);
  for (const Section& section : sections.sections) {
    require_finite(section.gain);
    for (const auto& pole : section.poles) require_finite(pole.real() + pole.imag());
  }
}
const Registered sections_reader{"sections", read_sections_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
