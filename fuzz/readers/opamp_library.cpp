#include "circuit/opamp_library.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_opamp_bytes(std::string_view bytes) {
  Provenance from;
  circuit::OpAmpLibrary::read(as_file(bytes, "opamps.toml"), from);
}
const Registered opamp_reader{"opamp_library", read_opamp_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
