#include "fpaa/cams/comparator.hpp"

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& comparator_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "Comparator";
    f.options = {ComparatorSpec::kSignalGround, "Dual Input", "Variable Reference"};
    f.parameters = {{"hysteresis_v"}};
    f.resources = Resources{.opamps = 0, .capacitors = 0, .comparators = 1};
    f.transfer = "logic: input above reference";
    f.transfer_ground = Ground::seen;
    f.limits = "hysteresis 0 or 0.01 V";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
