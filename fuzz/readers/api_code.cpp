#include "fpaa/streams/api_code.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_api_code_bytes(std::string_view bytes) {
  fpaa::parse_api_code(bytes, "ApiCode.c");
}
const Registered api_code_reader{"api_code", read_api_code_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
