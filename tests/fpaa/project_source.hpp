#pragma once

#include <fmt/format.h>

#include <string>

#include "fpaa/device/config_stream.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// An ApiCode.c in the form of the vendor's generator, for a project in which the plan's CAMs were placed:
/// two CAMs a CAB, capacitor c of CAB k at bank 2k + 3, byte 7 - c.
inline std::string project_source(const Plan& plan) {
  std::string out =
      "#include \"ApiCode.h\"\n\n/* maps */\nconst an_Byte an_apiAddress1[an_apiChipCount] =\n{\n";
  for (size_t i = 0; i < plan.chips.size(); ++i) {
    out +=
        fmt::format("   0x{:02X}{}  /* an_FPAA{} */\n", i + 1, i + 1 < plan.chips.size() ? "," : "", i + 1);
  }
  out += "};\n";
  for (const ChipPlan& chip : plan.chips) {
    ConfigStream primary;
    primary.primary = true;
    primary.address1 = chip.chip;
    primary.control = 0xC1;
    primary.blocks = {{0, 4, {0x20, 0x04, 0x00, 0x02, 0x1D}}};
    out += fmt::format("const an_Byte an_FPAA{}_PrimaryConfigInfo[] = \n{{\n   /* header */\n", chip.chip);
    for (const std::uint8_t byte : encode(primary)) out += fmt::format("   0x{:02X}, /* byte */\n", byte);
    out += "};\n\n";
  }
  for (const ChipPlan& chip : plan.chips) {
    int used[5] = {0, 0, 0, 0, 0};
    for (const PlacedCam& cam : chip.cams) {
      out += fmt::format("/* Component data table for the apiCapacitor's of {}. */\n", cam.name);
      out += fmt::format("extern const an_apiCapacitor an_FPAA{}_{}_Capacitor[{}] = \n{{\n", chip.chip,
                         cam.name, cam.capacitors.size());
      for (const Capacitor& c : cam.capacitors) {
        const int bank = 2 * (cam.cab - 1) + 3;
        const int byte = 7 - used[cam.cab]++;
        out += fmt::format("   /* {:<5} */ {{ 0x{:02X}, 0x{:02X}, }}, /* {}, {} */\n", c.name, bank, byte,
                           bank, byte);
      }
      out += "};\n\n";
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
