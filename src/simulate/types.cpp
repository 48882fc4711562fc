#include "simulate/types.hpp"

namespace bodesmith::simulate {

std::string_view to_string(Engine engine) {
  switch (engine) {
    case Engine::automatic:
      return "automatic";
    case Engine::record:
      return "record";
    case Engine::exact:
      return "exact";
    case Engine::cvode:
      return "cvode";
  }
  return "";
}

Options Options::finer() const {
  Options out = *this;
  out.relative_tolerance *= 0.1;
  out.absolute_tolerance *= 0.1;
  return out;
}

}  // namespace bodesmith::simulate
