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
      break;
  }
  return "nothing";
}

std::string_view to_string(IoCell::Mode mode) {
  using Mode = IoCell::Mode;
  switch (mode) {
    case Mode::off:
      return "off";
    case Mode::input:
      return "input, bypass";
    case Mode::amplifier_input:
      return "input, amplifier";
    case Mode::output:
      return "output, bypass";
    case Mode::sampled_output:
      return "output, sampled";
    case Mode::unconnected:
      return "not connected";
    case Mode::unknown:
      break;
  }
  return "unknown";
}

}  // namespace bodesmith::fpaa::an231
