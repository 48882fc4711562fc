#include "base/documents/document.hpp"
#include "lti/fractional_transfer.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_fractional_bytes(std::string_view bytes) {
  FractionalTransfer::from_node(parse_toml(bytes, "fractional.toml"));
}
const Registered fractional_reader{"fractional", read_fractional_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
