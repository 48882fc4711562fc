#pragma once

#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

class Cam;

/// CAM Hold: H = 1/z, output held for the full cycle; two capacitors, one op-amp. Two Holds in series need
/// opposite phases, and a half-cycle CAM needs one before a bypass output.
struct Hold {
  ZTransfer transfer() const { return {{0.0, 1.0}, {1.0}}; }
};

const Cam& hold_cam();

}  // namespace bodesmith::fpaa
