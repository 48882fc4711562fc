#include "fpaa/cams/cam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "base/text.hpp"

namespace bodesmith::fpaa {

void PlacedCam::find_z() {
  const std::vector<DeltaTransfer> made = cam->transfers(*this, CapacitorUnits(capacitors));
  z = made[0].in_z();
  for (std::size_t i = 1; i < made.size(); ++i) more_numerators[i - 1] = made[i].in_z().numerator;
}

std::string_view PlacedCam::cam_name() const {
  return cam->name();
}

const CamParameter* Cam::parameter(std::string_view key) const {
  const auto at = std::find_if(facts_.parameters.begin(), facts_.parameters.end(),
                               [&](const CamParameter& p) { return p.key == key; });
  return at == facts_.parameters.end() ? nullptr : &*at;
}

std::vector<DeltaTransfer> Cam::transfers(const PlacedCam& cam, const CapacitorUnits&) const {
  std::vector<DeltaTransfer> out;
  for (std::size_t i = 1; i <= cam.input_count(); ++i) out.push_back(in_delta(cam.z_from(i)));
  return out;
}

}  // namespace bodesmith::fpaa
