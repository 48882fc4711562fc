#pragma once

#include "fpaa/cams/cam.hpp"
#include "fpaa/device/memory_image.hpp"
#include "fpaa/streams/plan_stream.hpp"

namespace bodesmith::fpaa::an231 {

/// Facts an231, part 4: a low pass from IO1 to IO3 at 250 kHz, Cin = Cout = 12, Cint = 185, Clock 0 = ACLK/64.
inline const Bytes& worked_example() {
  static const Bytes bytes = {
      0xD5, 0xB7, 0x20, 0x01, 0x00, 0x01, 0xC1,                    // synch, device, address, control
      0xC4, 0x00, 0x0E, 0x20, 0x04, 0x00, 0x20, 0x05,              // clocks and their power
      0x00, 0x00, 0x40, 0x00, 0x00, 0x51, 0xFF, 0x0F, 0xF1, 0x2A,  //
      0xC2, 0x01, 0x01, 0x40, 0x2A,                                // digital pin off
      0xDE, 0x01, 0x0A, 0x02, 0xFF, 0,    0,    0,    0x50, 0,    0,    0,
      0x10, 0x2A,                                                              // routes of the cells
      0xCD, 0x02, 0x01, 0x10, 0x2A,                                            // IO3 output
      0xD3, 0x02, 0x01, 0x40, 0x2A,                                            // IO1 input
      0xC5, 0x03, 0x03, 0xB9, 0x0C, 0x0C, 0x2A,                                // C3, C2, C1
      0xDC, 0x03, 0x07, 0x01, 0x13, 0x01, 0x81, 0x0C, 0x00, 0x01, 0x2A,        // C2; ClockA; column line
      0x97, 0x04, 0x09, 0x30, 0x00, 0x10, 0x00, 0x05, 0x01, 0x19, 0x01, 0x81,  // C3, op-amp, C1
      0x2A};
  return bytes;
}

/// A CAM with these capacitors at Clock 0 = ACLK/64.
inline PlacedCam cam_of(const char* cam_name, const char* option, std::vector<Capacitor> capacitors,
                        int phase = 1) {
  PlacedCam cam;
  cam.cam = cam_registry().find(cam_name);
  cam.option = option;
  cam.clock_a = {250e3};
  cam.capacitors = std::move(capacitors);
  cam.phase = phase;
  return cam;
}

/// A chain from chip1.in1 to chip1.out1, two a CAB.
inline Plan chain_of(const std::vector<PlacedCam>& cams) {
  Plan plan;
  ChipPlan& chip = plan.chips.emplace_back();
  chip.master_clock = {16e6};
  std::string from = "chip1.in1";
  for (std::size_t i = 0; i < cams.size(); ++i) {
    chip.cams.push_back(cams[i]);
    chip.cams[i].name = "Stage" + std::to_string(i + 1);
    chip.cams[i].cab = static_cast<int>(i) / 2 + 1;
    const std::string to = "chip1." + chip.cams[i].name;
    plan.wires.push_back({from, to});
    from = to;
  }
  plan.wires.push_back({from, "chip1.out1"});
  return plan;
}

/// Pole-zero stages of four different capacitors each.
inline std::vector<PlacedCam> pole_zero_stages(int count) {
  std::vector<PlacedCam> out;
  for (int i = 0; i < count; ++i) {
    out.push_back(cam_of("FilterBilinear", "Pole and Zero",
                         {{"Ca", 3 + i}, {"Cb", 120 + 7 * i}, {"Cc", 2 + i}, {"Cd", 200 - 9 * i}}));
  }
  return out;
}

struct BuiltChip {
  MemoryImage memory;
  PinCells pins;
};
inline BuiltChip built(const Plan& plan, const PinCells& cells = {}) {
  const PlanStreams made = value_or_throw(plan_streams(plan, cells));
  return {made.chips[0].memory, made.cells};
}

}  // namespace bodesmith::fpaa::an231
