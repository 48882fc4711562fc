#include "simulate/types.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"

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

void require_few_edges(double edges, std::string_view what, double most) {
  if (edges <= most) return;
  throw InputError(fmt::format("{} has {} edges within the record, expected at most {}", what,
                               rounded_text(edges, 3), rounded_text(most)));
}

}  // namespace bodesmith::simulate
