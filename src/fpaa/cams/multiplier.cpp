#include "fpaa/cams/multiplier.hpp"

#include <algorithm>
#include <cmath>

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

double Multiplier::quantised(double y_v) {
  const double step = 6.0 / 256.0;
  const double code = std::clamp(std::floor((y_v + 3.0) / step), 0.0, 255.0);
  return (code + 0.5) * step - 3.0;
}

const CamType& multiplier_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "Multiplier";
    t.options = {"Sample and Hold Off", "Sample and Hold On"};
    t.parameters = {"scale_per_v"};
    t.resources = Resources{.opamps = 1, .capacitors = 4, .comparators = 1, .sars = 1, .lookup_tables = 0};
    t.transfer = "scale X Y/z, Y converted to 8 bits over +-3 V";
    t.transfer_ground = Ground::seen;
    t.delay_cycles = 1.0;
    t.clock_b_ratio = 16;
    t.limits = "scale 0.33 to 4; with sample and hold 6 capacitors and 2 op-amps";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
