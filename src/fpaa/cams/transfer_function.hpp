#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "base/error.hpp"
#include "fpaa/cams/cam_values.hpp"
#include "fpaa/device/board.hpp"

namespace bodesmith::fpaa {

/// CAM TransferFunction: the input is converted to 8 bits over -3 ... +3 V, a byte of the chip's look-up
/// table sets the output, Vout = 2 V (LUT - 128)/Cout, Cout = round(254/max |V|)
/// (an_setTransferFunctionTable). One cycle late; ClockB = 16 ClockA; one look-up table a chip.
struct LookupTable {
  std::array<std::uint8_t, 256> bytes{};
  int cout = 127;

  /// Voltage at the middle of an entry's input step.
  static double input_v(std::size_t entry) {
    return (static_cast<double>(entry) + 0.5) * 2.0 * kFullScaleV / 256.0 - kFullScaleV;
  }
  static std::size_t entry_of(double input_v);
  double output_v(std::size_t entry) const { return 2.0 * (bytes[entry] - 128) / cout; }
  double output(double in_v) const { return output_v(entry_of(in_v)); }

  /// The table of a static function of volts, limited to full scale. Refused when it is 0
  /// everywhere or not finite.
  static Outcome<LookupTable> of(const std::function<double(double)>& function);
  /// The table as a placed CAM carries it ("cout", "table_hex": 512 digits), and back.
  CamValues values() const;
  static LookupTable from(const CamValues& values);
  /// `entry,input_v,wanted_v,output_v,byte`: the file to load in the CAM's dialog, 256 rows.
  std::string csv(const std::function<double(double)>& wanted) const;
};

}  // namespace bodesmith::fpaa
