#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/cams/switches.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/device/memory_image.hpp"

namespace bodesmith::fpaa::an231 {

/// What an input of a stage, or an output pin, reads: another stage of the chip or an input pin.
struct SignalRef {
  std::optional<std::size_t> stage;
  std::string pin;  ///< "in1", when it is no stage
};

struct WantedStage {
  std::string name;  ///< for messages
  StageSwitches switches;
  int cab = 1;
  int clock = 0;  ///< chip clock
  std::vector<SignalRef> inputs;
  /// The look-up stage instead of capacitors of known switches (lookup_stage.hpp); `switches` then only says
  /// how its output stands.
  std::optional<LookupTable> lookup = std::nullopt;
};

struct WantedPin {
  std::string name;  ///< "out1"
  SignalRef from;
};

/// One chip as stages, wires and clocks, before anything has its place.
struct WantedChip {
  int address1 = 1;
  int system_divisor = 1;
  std::map<int, int> clock_divisors;  ///< chip clock -> divisor behind the system divisor
  std::vector<WantedStage> stages;
  std::vector<std::string> inputs;  ///< pins "in1", …, in order
  std::vector<WantedPin> outputs;
  std::map<std::string, int> cells;  ///< I/O cells the user chose for pins
};

struct BuiltChip {
  MemoryImage memory;
  std::map<std::string, int> pins;  ///< "in1" -> 1 (IO1)
  std::vector<std::string> notes;
};

/// Gives op-amps, capacitors, clocks, I/O cells and lines to a chip and writes its memory. Refused, in one
/// line, where a CAB is too small, lines do not suffice, or one of the vendor's rules is broken (a half-period
/// output at a static branch, read in the wrong phase, or by another clock).
Outcome<BuiltChip> build_chip(const WantedChip& chip);

}  // namespace bodesmith::fpaa::an231
