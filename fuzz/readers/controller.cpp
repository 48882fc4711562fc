#include "reader.hpp"
#include "simulate/controller_file.hpp"

namespace bodesmith::fuzz {
namespace {

void read_controller_bytes(std::string_view bytes) {
  Provenance from;
  const auto loop = simulate::read_controller(as_file(bytes, "controller.toml"), from);
  const simulate::PidController& c = loop.controller;
  for (const double value :
       {c.proportional, c.integral_per_s, c.derivative_s, c.derivative_corner.value, c.period_s})
    require_finite(value);
}
const Registered controller_reader{"controller", read_controller_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
