#include "fpaa/cams/cam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "base/text.hpp"
#include "fpaa/cams/cam_step.hpp"

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

std::optional<Resources> Cam::resources(std::size_t) const {
  return facts_.resources;
}

std::string Cam::note(const PlacedCam&) const {
  return {};
}

std::vector<DeltaTransfer> Cam::transfers(const PlacedCam& cam, const CapacitorUnits&) const {
  std::vector<DeltaTransfer> out;
  for (std::size_t i = 1; i <= cam.input_count(); ++i) out.push_back(in_delta(cam.z_from(i)));
  return out;
}

std::unique_ptr<CamStep> Cam::step(const PlacedCam&) const {
  return nullptr;
}

std::vector<Capacitor> Cam::vendor_capacitors(const PlacedCam& cam, std::span<const std::string>) const {
  return cam.capacitors;
}

std::optional<StageSwitches> Cam::switches(const PlacedCam&, const CapacitorUnits&) const {
  return std::nullopt;
}

std::optional<ZrnaModule> Cam::zrna_module(const PlacedCam&) const {
  return std::nullopt;
}

std::string Cam::picture_text(const PlacedCam&) const {
  return {};
}

}  // namespace bodesmith::fpaa
