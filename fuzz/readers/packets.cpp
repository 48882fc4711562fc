#include "fpaa/device/config_stream.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_packets_bytes(std::string_view bytes) {
  for (const fpaa::Packet& packet : fpaa::from_packets(bytes, "packets.bin"))
    fpaa::decode(packet.bytes, "packets.bin");
}
const Registered packets_reader{"packets", read_packets_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
