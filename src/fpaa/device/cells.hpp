#pragma once

#include <array>

#include "fpaa/device/board.hpp"
#include "fpaa/device/circuit_node.hpp"
#include "fpaa/device/memory_image.hpp"

namespace bodesmith::fpaa::an231 {

// Where things stand in the memory: one place for decoder and generator. Facts: an231, part 1.

inline constexpr int kLines =
    2;  ///< direct lines into a CAB, column lines of a column, local inputs of a CAB

using Address = MemoryPlace;

// Bank 0.
constexpr Address clock_divisor_at(int clock) {
  return {0, clock < 4 ? 7 - clock : clock == 4 ? 3 : 1};
}
inline constexpr Address kClockPower{0, 0x08};  ///< bit 0 always, bit 2 + k: Clock k
inline constexpr Address kSystem1{0, 0x09};
inline constexpr Address kSystem2{0, 0x0A};

/// A byte whose meaning is not known, or only in part, and its value in public vendor streams.
struct Constant {
  Address address;
  int value;
  const char* what;
};
inline constexpr std::array<Constant, 8> kConstants = {{
    {{0, 0x0B}, 0x40, "which system clock feeds which chip clock? (51 of 52 public streams)"},
    {{0, 0x0E}, 0x51, "meaning unknown (52 of 52)"},
    {{0, 0x0F}, 0xFF, "meaning unknown, perhaps enable bits of an auto-null (51 of 52)"},
    {{0, 0x10}, 0x0F, "meaning unknown, perhaps enable bits of an auto-null (50 of 52)"},
    {{0, 0x11}, 0xF1, "power of the analogue cells and references (52 of 52)"},
    {{1, 0x02}, 0x40, "digital output pin off (43 of 52)"},
    {{1, 0x1E}, 0x02, "meaning unknown (52 of 52)"},
    {{1, 0x1F}, 0xFF, "Address2 (52 of 52)"},
}};

inline constexpr int kLookupBank = 16;  ///< first of eight with the look-up table

// Bank 2.
struct CellBytes {
  int option1;  ///< -1: has none
  int option2;
  int mode;
};
constexpr CellBytes cell_bytes(int cell) {
  constexpr std::array<CellBytes, kIoCells> table = {{{0x11, 0x12, 0x13},
                                                      {0x0E, 0x0F, 0x10},
                                                      {0x0B, 0x0C, 0x0D},
                                                      {0x08, 0x09, 0x0A},
                                                      {-1, -1, 0x16},
                                                      {-1, -1, 0x15},
                                                      {-1, -1, 0x14}}};
  return table[static_cast<std::size_t>(cell - 1)];
}
inline constexpr int kIoBank = 2;
inline constexpr int kModeInput = 0x40;
inline constexpr int kModeOutput = 0x10;
inline constexpr int kModeSampled = 0x03;
inline constexpr int kModeBypass = 0x08;  ///< cells 5 to 7, either way; cells 1 to 4: not connected
inline constexpr int kModeAmplifier = 0x05;
inline constexpr int kSampledBase = 0x42;  ///< + 8 Clock + 4 if it samples in phase 1
inline constexpr int kSampledPhase1 = 0x04;

/// Columns: odd is CAB 1 and 3, even CAB 2 and 4.
enum class Column { odd, even };
inline constexpr std::array<Column, 2> kColumns = {Column::odd, Column::even};
constexpr Column column_of(int cab) {
  return cab % 2 == 1 ? Column::odd : Column::even;
}
/// Cells 1, 2, 5, 6 stand next to CAB 1 and 2, cells 3, 4, 7 next to CAB 3 and 4.
constexpr bool is_low(int cell) {
  return cell == 1 || cell == 2 || cell == 5 || cell == 6;
}
/// The CAB of a column next to a cell.
constexpr int cab_next_to(int cell, Column column) {
  return (is_low(cell) ? 1 : 3) + (column == Column::odd ? 0 : 1);
}
struct Nibble {
  int byte;
  bool high;
};
constexpr Nibble route_nibble(int cell, Column column) {
  constexpr std::array<Nibble, kIoCells> odd = {
      {{7, true}, {7, false}, {3, true}, {3, false}, {6, true}, {6, false}, {2, true}}};
  Nibble out = odd[static_cast<std::size_t>(cell - 1)];
  if (column == Column::even) out.byte -= 2;
  return out;
}
inline constexpr int kNibbleDirect = 1;      ///< 1, 2: direct line 1, 2
inline constexpr int kNibbleColumnLine = 5;  ///< 5, 6: column line 1, 2
inline constexpr int kNibbleOpAmp1 = 0xC;
inline constexpr int kNibbleOpAmp2 = 0x8;

// CABs.
constexpr int bank_a(int cab) {
  return 2 * cab + 1;
}
constexpr int bank_b(int cab) {
  return 2 * cab + 2;
}
constexpr Address capacitor_at(int cab, int capacitor) {
  return {bank_a(cab), 8 - capacitor};
}
/// First of the four bytes: near word, far word.
constexpr Address switches_at(int cab, int capacitor) {
  constexpr std::array<int, kCapacitors> byte = {0x1C, 0x1C, 0x16, 0x18, 0x10, 0x14, 0x0C, 0x10};
  const bool even = capacitor % 2 == 0;
  return {even ? bank_a(cab) : bank_b(cab), byte[static_cast<std::size_t>(capacitor - 1)]};
}
constexpr Address opamp_at(int cab, int opamp) {
  return {bank_b(cab), opamp == 1 ? 0x1A : 0x14};
}
constexpr Address cab_clocks_at(int cab) {
  return {bank_b(cab), 0x00};
}
constexpr Address line_drivers_at(int cab) {
  return {bank_b(cab), 0x02};
}
constexpr Address local_input_at(int cab, int input) {
  return {bank_b(cab), input == 1 ? 0x05 : 0x04};
}
/// Bit of the line drivers' byte.
constexpr int line_driver_bit(int opamp, int line) {
  return (opamp == 1 ? 0x01 : 0x02) << (line == 1 ? 0 : 3);
}
/// Nibble of a CAB's clock byte: C to F are Clock 0 to 3, A and B Clock 4 and 5.
constexpr int clock_nibble(int clock) {
  return clock < 4 ? 0xC + clock : 0xA + clock - 4;
}

inline constexpr int kStatic = 0x00;
inline constexpr int kByClockA = 0x01;
inline constexpr int kByClockB = 0x02;
inline constexpr int kFarGround = 8;
inline constexpr int kNearGround = 1;
inline constexpr int kOpAmpOn = 0x05;
inline constexpr int kResetPhase1 = 0x40;  ///< + clock
inline constexpr int kResetPhase2 = 0x80;

/// What a near selector points at, before lines are followed.
CircuitNode selected(int cab, int selector);
/// The selector by which a CAB reads an op-amp of any CAB, a local input, or its direct line.
int opamp_selector(int cab, int source_cab, int opamp);
int local_input_selector(int input);
int direct_line_selector(int cab, int line);

}  // namespace bodesmith::fpaa::an231
