#include "fpaa/streams/lookup_stage.hpp"

#include <fmt/format.h>

#include "fpaa/device/cells.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

constexpr int kMiddleOfTable = 128;
constexpr int kConverterUnits = 170;
constexpr int kSeenSelector = 0xA;  ///< of the converter's input, in all of the public streams

struct CopiedByte {
  Address address;
  int value;
};
/// Converter and table counter, alike in all public streams that have the stage in this CAB.
constexpr CopiedByte kCopied[] = {
    {{1, 0x05}, 0x02},
    {{1, 0x10}, 0x09},
    {{1, 0x11}, 0x86},
    {{1, 0x12}, 0xC0},
    {{1, 0x13}, 0x30},
    {{1, 0x15}, 0x02},
    {{bank_a(kLookupCab), 0x0F}, 0xA8},
    {{bank_b(kLookupCab), 0x09}, 0x1B},
    {{bank_b(kLookupCab), 0x0B}, 0x03},
};

void write_words(MemoryImage& memory, int capacitor, int units, std::array<int, 4> words) {
  const Address units_at = capacitor_at(kLookupCab, capacitor);
  memory.set(units_at.bank, units_at.byte, units);
  const Address at = switches_at(kLookupCab, capacitor);
  for (int i = 0; i < 4; ++i) memory.set(at.bank, at.byte + i, words[static_cast<std::size_t>(i)]);
}

}  // namespace

void write_lookup(MemoryImage& memory, const LookupTable& table, int input_selector) {
  for (std::size_t i = 0; i < table.bytes.size(); ++i) {
    const int flat = static_cast<int>(i);
    memory.set(kLookupBank + flat / MemoryImage::kBankBytes, flat % MemoryImage::kBankBytes, table.bytes[i]);
  }
  for (const CopiedByte& byte : kCopied) memory.set(byte.address.bank, byte.address.byte, byte.value);
  write_words(memory, 1, kMiddleOfTable, {kByClockB, 0x15, kStatic, 0x10});  // +2 V, ground; static
  write_words(memory, 2, 0xFF, {kByClockB, 0x14, kStatic, 0x10});            // -2 V, ground; static
  write_words(memory, 3, table.cout, {kByClockB, 0x13, kStatic, 0x10});      // own output, ground; static
  write_words(memory, 7, kConverterUnits, {kByClockA, 0x10 | input_selector, kByClockA, 0x48});
  write_words(memory, 8, kMiddleOfTable, {0x05, 0x14, 0x2D, 0x48});
  const Address opamp = opamp_at(kLookupCab, 1);
  memory.set(opamp.bank, opamp.byte, kResetPhase2 | kByClockB);
  memory.set(opamp.bank, opamp.byte + 1, kOpAmpOn);
}

std::string lookup_note(const std::string& name, int input_selector) {
  std::string bytes;
  for (const CopiedByte& byte : kCopied) {
    bytes += fmt::format("{}{:X}:{:02X} = {:02X}", bytes.empty() ? "" : ", ", byte.address.bank,
                         byte.address.byte, byte.value);
  }
  std::string out = fmt::format(
      "{} is the look-up stage: its converter and table counter ({}, and the switch words of C7 and C8 of CAB {}) "
      "are copied from what all public streams with it have in common, their meaning is not known; its clocks are "
      "Clock {} and Clock {} as there.",
      name, bytes, kLookupCab, kLookupFastClock, kLookupSlowClock);
  if (input_selector != kSeenSelector) {
    out += fmt::format(
        " Its converter reads selector {:X}; public streams have only A there (op-amp 2 of CAB 1).",
        input_selector);
  }
  return out;
}

}  // namespace bodesmith::fpaa::an231
