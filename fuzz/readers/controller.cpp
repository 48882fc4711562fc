#include "reader.hpp"
#include "simulate/controller_file.hpp"

namespace bodesmith::fuzz {
namespace {

void read_controller_bytes(std::string_view bytes) {
  Provenance from;
  simulate::read_controller(as_file(bytes, "controller.toml"), from);
}
const Registered controller_reader{"controller", read_controller_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
