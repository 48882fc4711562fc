#include "tracking/types.hpp"

#include <algorithm>

namespace bodesmith::tracking {

std::string to_string(GeneratorForm form) {
  if (form.is_self_fed()) return "self_fed";
  if (form.passes == 1) return "one_pass";
  if (form.passes == 2) return "two_passes";
  return std::to_string(form.passes) + "_passes";
}

std::string_view to_string(Method method) {
  switch (method) {
    case Method::harmonic:
      return "harmonic";
    case Method::cvode:
      return "cvode";
  }
  return "";
}

const Case* Report::find(Hertz frequency, const std::string& design) const {
  const auto found = std::find_if(cases.begin(), cases.end(), [&](const Case& c) {
    return c.frequency == frequency && c.design == design;
  });
  return found == cases.end() ? nullptr : &*found;
}

}  // namespace bodesmith::tracking
