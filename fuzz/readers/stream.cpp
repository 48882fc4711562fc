#include <stdexcept>

#include "fpaa/device/config_stream.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_stream_bytes(std::string_view bytes) {
  const fpaa::Bytes stream(bytes.begin(), bytes.end());
  if (fpaa::encode(fpaa::decode(stream, "stream.bin")) != stream) throw std::logic_error("a stream changed");
}
const Registered stream_reader{"stream", read_stream_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
