#include "fpaa/cams/integrator.hpp"

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& integrator_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "Integrator";
    f.options = {"Inverting", "Non-inverting"};
    f.parameters = {{"integration_constant_per_s"}};
    f.resources = Resources{.opamps = 1, .capacitors = 2};
    f.transfer =
        "inverting -(Cin/Cint)/(1 - 1/z), non-inverting (Cin/Cint) z^-1/(1 - 1/z); constant fc Cin/Cint";
    f.transfer_ground = Ground::derived;
    f.limits = "constant fc/255 to 255 fc";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
