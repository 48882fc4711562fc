#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "fpaa/device/board.hpp"

namespace bodesmith::fpaa {

/// The clocks of one AN231 chip: ACLK is divided by `system_divisor[0|1]` to the two system clocks sys1,
/// sys2, and each chip clock (Clock 0-5) is one of them divided again. Legal divisors are 1, 2, 4, ... 510 at
/// both steps (configuration byte 0 means 1, byte N means 2N).
struct ChipClock {
  int system = 1;  ///< 1 or 2
  int divisor = 1;
  friend bool operator==(const ChipClock&, const ChipClock&) = default;
};

inline constexpr int kLargestDivisor = 510;  ///< of a system clock, and of a chip clock

struct ClockPlan {
  int sys1_divisor = 1;
  int sys2_divisor = 1;
  std::vector<ChipClock> clocks;  ///< Clock 0, 1, ... in use (filters use 0-3)

  Hertz frequency(Hertz master, std::size_t clock) const;
};

bool is_legal_divisor(int divisor);
/// The byte that stands for a divisor in the configuration memory.
int divisor_byte(int divisor);
/// A frequency and one way to reach it.
struct LegalClock {
  Hertz frequency;
  int system_divisor = 1;
  int divisor = 1;
};
/// The way to reach a frequency exactly (relative 1e-9), or nothing.
std::optional<LegalClock> find_clock(const Board& board, Hertz frequency);
/// The smallest system divisor from which chip clocks with all these total divisors of the master clock come; nothing where none does.
/// (Both system clocks get it: no public stream shows which of them a chip clock takes.)
std::optional<int> common_system_divisor(std::span<const std::int64_t> totals);
/// The legal clock nearest (in ratio) to a frequency.
LegalClock nearest_clock(const Board& board, Hertz frequency);

}  // namespace bodesmith::fpaa
