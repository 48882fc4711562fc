#include "lti/cascade.hpp"
#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_cascade_bytes(std::string_view bytes) {
  require_finite(Cascade::from_node(parse_json(bytes, "cascade.json")).to_json());
}
const Registered cascade_reader{"cascade", read_cascade_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
