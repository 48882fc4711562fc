#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fpaa/device/config_stream.hpp"

namespace bodesmith::fpaa {

/// What the vendor's tool generated for a person's own project (ApiCode.c): where each capacitor of each CAM
/// sits in the configuration memory, and the chips' addresses.
struct ApiProject {
  struct Capacitor {
    std::string name;
    int bank = 0;
    int byte = 0;
  };
  struct Cam {
    std::string chip;  ///< "FPAA1"
    std::string name;  ///< "FilterBilinear1"
    std::vector<Capacitor> capacitors;
    int line = 0;
  };
  struct Chip {
    std::string name;
    int address1 = 1;
  };
  std::string file;
  std::string prefix;  ///< of every name: "an" or "ot"
  std::vector<Chip> chips;
  std::vector<Cam> cams;

  const Cam* find(const std::string& chip, const std::string& cam) const;
};

/// Reads the tables `<prefix>_<chip>_<cam>_Capacitor[n] = { /* Cin */ { 0x03, 0x07, }, … };`, the array of
/// Address1 and the arrays `<prefix>_<chip>_PrimaryConfigInfo[]`. Throws InputError with file and line.
ApiProject parse_api_code(std::string_view text, const std::string& file);

}  // namespace bodesmith::fpaa
