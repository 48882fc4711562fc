#pragma once

namespace bodesmith::fpaa {

class Cam;

/// CAM GainHold, inverting: V[n] = -Cin/Cout X[n], the output held for the whole cycle; a third capacitor of
/// 255 units holds it; one op-amp (facts/an231, part 2).
///
/// Not inverting and in phase 2 it is not quite held: while the third capacitor holds (phase 1), Cin already
/// follows the input, so that the output moves by -Cin/255 of the input's next step, until phase 2 sets it.
/// (In phase 1 the same input is still there; where it inverts, Cin is at ground then.)
struct GainHold {
  static constexpr int kHoldUnits = 255;
};

const Cam& gain_hold_cam();

}  // namespace bodesmith::fpaa
