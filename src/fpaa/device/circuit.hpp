#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "fpaa/device/cells.hpp"
#include "fpaa/device/circuit_node.hpp"
#include "fpaa/device/memory_image.hpp"

namespace bodesmith::fpaa::an231 {

/// One plate's switch.
struct SwitchWord {
  enum class Clock { none, a, b, other };
  Clock clock = Clock::none;
  std::array<CircuitNode, 2> at;  ///< in phase 1 and 2 (the same when static)
};

struct CapacitorCell {
  int number = 1;  ///< C1 to C8
  int units = 0;
  SwitchWord near;
  SwitchWord far;
  bool is_understood = true;
};

struct OpAmpCell {
  bool on = false;
  int reset_phase = 0;  ///< its feedback switch is closed in this phase: a half-period output; 0: never
  SwitchWord::Clock reset_clock = SwitchWord::Clock::none;
};

struct CabCell {
  int cab = 1;
  std::optional<int> clock_a;  ///< chip clock
  std::optional<int> clock_b;
  std::array<OpAmpCell, kOpAmps> opamps;
  std::vector<CapacitorCell> capacitors;  ///< those that are not zero

  std::optional<int> clock(SwitchWord::Clock by) const {
    return by == SwitchWord::Clock::a ? clock_a : by == SwitchWord::Clock::b ? clock_b : std::nullopt;
  }
};

/// A byte and what is (not) known of it.
struct MemoryRemark {
  Address address;
  int value = 0;
  std::string what;
};

/// What the memory of one chip makes: capacitors between op-amps and pins, switched by clocks.
struct ChipCircuit {
  int address1 = 1;
  int system1_divisor = 1;
  int system2_divisor = 1;
  std::array<int, kClocks> divisors{};  ///< of Clock 0 to 5, behind the system divisor
  std::array<bool, kClocks> powered{};
  std::array<CabCell, kCabs> cabs;
  std::array<IoCell, kIoCells> cells;
  std::vector<int> lookup_table;          ///< 256 bytes, -3 V first; empty: none is written
  std::vector<std::string> problems;      ///< what cannot work: two drivers, none, an op-amp that is off, …
  std::vector<std::string> notes;         ///< what a person should know
  std::vector<MemoryRemark> constants;    ///< bytes of unknown meaning with their usual value
  std::vector<MemoryRemark> unexplained;  ///< carried through, not understood

  const CabCell& cab(int number) const { return cabs.at(static_cast<std::size_t>(number - 1)); }
  const IoCell& cell(int number) const { return cells.at(static_cast<std::size_t>(number - 1)); }
  /// Frequency of a chip clock for this ACLK. Both system clocks are taken to be equal (which of them feeds a
  /// chip clock is not known): sys1 counts, and a difference is a problem.
  Hertz clock(int number, Hertz master) const;
};

ChipCircuit read_circuit(const MemoryImage& memory, int address1);

}  // namespace bodesmith::fpaa::an231
