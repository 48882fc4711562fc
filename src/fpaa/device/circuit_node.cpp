#include "fpaa/device/circuit_node.hpp"

#include <fmt/format.h>

namespace bodesmith::fpaa::an231 {

std::string CircuitNode::text() const {
  switch (kind) {
    case Kind::open:
      return "open";
    case Kind::ground:
      return "ground";
    case Kind::virtual_ground:
      return fmt::format("CAB{}.vg{}", cab, number);
    case Kind::opamp:
      return fmt::format("CAB{}.op{}", cab, number);
    case Kind::pin:
      return fmt::format("IO{}", number);
    case Kind::reference:
      return number > 0 ? "+2 V" : "-2 V";
    case Kind::undriven:
    case Kind::local_input:
    case Kind::direct_line:
      break;
  }
  return "nothing";
}

std::string_view to_string(IoCell::Mode mode) {
  static constexpr const char* kNames[] = {
      "off",           "input, bypass", "input, amplifier", "output, bypass", "output, sampled",
      "not connected", "unknown"};
  return kNames[static_cast<std::size_t>(mode)];
}

}  // namespace bodesmith::fpaa::an231
