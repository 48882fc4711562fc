#include <stdexcept>

#include "fpaa/device/config_stream.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

/// What can be decoded is encoded to the same bytes.
void read_ahf_bytes(std::string_view bytes) {
  const fpaa::Bytes stream = fpaa::from_ahf(bytes, "chip1.ahf");
  if (fpaa::encode(fpaa::decode(stream, "chip1.ahf")) != stream) throw std::logic_error("a stream changed");
}
const Registered ahf_reader{"ahf", read_ahf_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
