#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/units.hpp"

namespace bodesmith::fpaa {

/// What a CAM, a CAB or a chip uses or offers.
struct Resources {
  int opamps = 0;
  int capacitors = 0;
  int comparators = 0;
  int sars = 0;
  int lookup_tables = 0;

  Resources& operator+=(const Resources& other);
  bool fits_in(const Resources& available) const;
};

// Of every chip of this family. A CAM never straddles CABs.
inline constexpr int kCabs = 4;
inline constexpr int kOpAmps = 2;      ///< of a CAB
inline constexpr int kCapacitors = 8;  ///< of a CAB
inline constexpr Resources kPerCab{.opamps = kOpAmps, .capacitors = kCapacitors, .comparators = 1, .sars = 1};
inline constexpr int kIoCells = 7;
inline constexpr int kClocks = 6;
/// Units of a capacitor: its number is one byte.
inline constexpr int kMostUnits = 255;
/// Signals are differential and clip at +- this; converters take as much.
inline constexpr double kFullScaleV = 3.0;

/// A board of equal field-programmable analog arrays. Everything here was seen in public vendor-generated
/// code; gain-bandwidth, slew rate, noise, offset and the unit capacitance are not publicly known and
/// therefore absent.
struct Board {
  std::string name;
  std::string chip;  ///< type of the FPAA
  int chips = 1;
  Hertz master_clock{16e6};
  Hertz settling_product{19.68e6};  ///< (1 + gain) * fc of a gain stage may not exceed this
};

/// AN231K04-QUAD4: four AN231E04.
const Board& an231k04_quad4();
/// The boards known by name, in a fixed order.
const std::vector<const Board*>& boards();
/// Refused with the known names.
Outcome<const Board*> find_board(std::string_view name);
/// The same, or DesignError: for boards that were found before.
const Board& board_by_name(std::string_view name);

}  // namespace bodesmith::fpaa
