#pragma once

namespace bodesmith::fpaa {

class Cam;

/// CAM GainHold, inverting: V[n] = -Cin/Cout X[n], the output held for the whole cycle; a third capacitor of
/// 255 units holds it; one op-amp (facts/an231, part 2).
struct GainHold {
  static constexpr int kHoldUnits = 255;
};

const Cam& gain_hold_cam();

}  // namespace bodesmith::fpaa
