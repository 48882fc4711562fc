#include "lti/cascade.hpp"
#include "base/document.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_cascade_bytes(std::string_view bytes) {
  const Cascade cascade = Cascade::from_node(parse_json(bytes, "cascade.json"));
  for (const auto& term : cascade.terms) require_finite(term.beta);
}
const Registered cascade_reader{"cascade", read_cascade_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
