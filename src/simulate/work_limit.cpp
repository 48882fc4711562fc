#include "simulate/work_limit.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::simulate {

void require_few_edges(double edges, std::string_view what, double most) {
  if (edges <= most) return;
  throw InputError(fmt::format("{} has {} edges within the record, expected at most {}", what,
                               rounded_text(edges, 3), rounded_text(most)));
}

}  // namespace bodesmith::simulate
