#include "fpaa/cams/multiplier.hpp"

#include <algorithm>
#include <cmath>

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

double Multiplier::quantised(double y_v) {
  const double step = 6.0 / 256.0;
  const double code = std::clamp(std::floor((y_v + 3.0) / step), 0.0, 255.0);
  return (code + 0.5) * step - 3.0;
}

const Cam& multiplier_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "Multiplier";
    f.options = {"Sample and Hold Off", "Sample and Hold On"};
    f.parameters = {{"scale_per_v"}};
    f.resources = Resources{.opamps = 1, .capacitors = 4, .comparators = 1, .sars = 1};
    f.transfer = "scale X Y/z, Y converted to 8 bits over +-3 V";
    f.transfer_ground = Ground::seen;
    f.delay_cycles = 1.0;
    f.clock_b_ratio = 16;
    f.limits = "scale 0.33 to 4; with sample and hold 6 capacitors and 2 op-amps";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
