#include "fpaa/cams/cam_type.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::fpaa {

// One line a CAM.
const CamType& filter_bilinear_type();
const CamType& filter_biquad_type();
const CamType& gain_inv_type();
const CamType& gain_half_type();
const CamType& gain_hold_type();
const CamType& gain_switch_type();
const CamType& gain_voltage_controlled_type();
const CamType& sum_diff_type();
const CamType& sum_filter_type();
const CamType& integrator_type();
const CamType& hold_type();
const CamType& multiplier_type();
const CamType& transfer_function_type();
const CamType& comparator_type();

const std::vector<const CamType*>& cam_types() {
  static const std::vector<const CamType*> all = {
      &filter_bilinear_type(),
      &filter_biquad_type(),
      &gain_inv_type(),
      &gain_half_type(),
      &gain_hold_type(),
      &gain_switch_type(),
      &gain_voltage_controlled_type(),
      &sum_diff_type(),
      &sum_filter_type(),
      &integrator_type(),
      &hold_type(),
      &multiplier_type(),
      &transfer_function_type(),
      &comparator_type(),
  };
  return all;
}

const CamType& cam_type(std::string_view name) {
  std::vector<std::string> names;
  for (const CamType* type : cam_types()) {
    if (type->name == name) return *type;
    names.emplace_back(type->name);
  }
  throw DesignError(
      fmt::format("'{}' is not a CAM of the library, expected one of: {}", name, join(names, ", ")));
}

std::string_view word(Ground ground) {
  switch (ground) {
    case Ground::seen:
      return "seen";
    case Ground::derived:
      return "derived";
    case Ground::assumed:
      return "assumed";
    case Ground::unknown:
      break;
  }
  return "unknown";
}

}  // namespace bodesmith::fpaa
