#include "fpaa/cams/cam.hpp"

#include <algorithm>

namespace bodesmith::fpaa {

void PlacedCam::find_z() {
  z = cam->transfer(*this, CapacitorUnits(capacitors));
}

std::string_view PlacedCam::cam_name() const {
  return cam->name();
}

const CamParameter* Cam::parameter(std::string_view key) const {
  const auto at = std::ranges::find(facts_.parameters, key, &CamParameter::key);
  return at == facts_.parameters.end() ? nullptr : &*at;
}

}  // namespace bodesmith::fpaa
