#include "fpaa/device/config_stream.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_c_array_bytes(std::string_view bytes) {
  fpaa::from_c_array(bytes, "", "primary.c");
}
const Registered c_array_reader{"c_array", read_c_array_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
