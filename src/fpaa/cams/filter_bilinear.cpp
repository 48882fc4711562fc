#include "fpaa/cams/filter_bilinear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

ZTransfer PoleZeroCapacitors::transfer() const {
  return {{-static_cast<double>(ca + cb), static_cast<double>(cb)},
          {static_cast<double>(cc + cd), -static_cast<double>(cd)}};
}
Hertz PoleZeroCapacitors::zero(Hertz clock) const {
  return branch_corner(ca, cb, clock);
}
Hertz PoleZeroCapacitors::pole(Hertz clock) const {
  return branch_corner(cc, cd, clock);
}

ZTransfer LowPassCapacitors::transfer() const {
  return {{-static_cast<double>(cin)}, {static_cast<double>(cout + cint), -static_cast<double>(cint)}};
}
Hertz LowPassCapacitors::corner(Hertz clock) const {
  return branch_corner(cout, cint, clock);
}

ZTransfer HighPassCapacitors::transfer() const {
  return {{-static_cast<double>(cb), static_cast<double>(cb)},
          {static_cast<double>(cc + cd), -static_cast<double>(cd)}};
}
Hertz HighPassCapacitors::corner(Hertz clock) const {
  return branch_corner(cc, cd, clock);
}

Hertz branch_corner(double c0, double c1, Hertz clock) {
  return {clock.value / std::numbers::pi * std::atan(c0 / (c0 + 2.0 * c1))};
}

double branch_ratio(Hertz corner, Hertz clock) {
  return 0.5 * (1.0 / std::tan(std::numbers::pi * corner.value / clock.value) - 1.0);
}

LowPassCapacitors vendor_low_pass(Hertz corner, double gain, Hertz clock, int largest) {
  const double w = 2.0 * clock.value * std::tan(std::numbers::pi * corner.value / clock.value);
  const double ratio = clock.value / w - 0.5;
  LowPassCapacitors best;
  double least = std::numeric_limits<double>::infinity();
  for (int cint = largest; cint >= 1; --cint) {
    const double cout = std::clamp(std::round(cint / ratio), 1.0, static_cast<double>(largest));
    const double cin = std::clamp(std::round(gain * cout), 1.0, static_cast<double>(largest));
    const double realised_w = 2.0 * clock.value * cout / (2.0 * cint + cout);
    const double error = std::abs(realised_w / w - 1.0) + std::abs(cin / cout / gain - 1.0);
    if (error < least) {
      least = error;
      best = {static_cast<int>(cin), cint, static_cast<int>(cout)};
    }
  }
  return best;
}

const CamType& filter_bilinear_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "FilterBilinear";
    t.options = {"Low Pass", "High Pass", "All Pass", "Pole and Zero"};
    t.parameters = {"corner_hz", "gain", "pole_hz", "zero_hz", "dc_gain", "high_frequency_gain"};
    t.resources = Resources{.opamps = 1, .capacitors = 4, .comparators = 0, .sars = 0, .lookup_tables = 0};
    t.transfer =
        "Low Pass: -Cin/(Cout + Cint(1 - 1/z)). Pole and Zero: -(Ca + Cb(1 - 1/z))/(Cc + Cd(1 - 1/z)). High "
        "Pass: the "
        "same without Ca. All Pass: not made (it needs a zero in the right half plane)";
    t.transfer_ground = Ground::assumed;
    t.limits = "corners from fc/1605 to about fc/4; low pass and high pass take 3 capacitors";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
