#include "fpaa/device/clock_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/whole_number.hpp"

namespace bodesmith::fpaa {
namespace {

const std::vector<int>& divisors() {
  static const std::vector<int> all = [] {
    std::vector<int> list{1};
    for (int d = 2; d <= kLargestDivisor; d += 2) list.push_back(d);
    return list;
  }();
  return all;
}

/// Total divisor -> its smallest system divisor.
const std::map<long, int>& total_divisors() {
  static const std::map<long, int> all = [] {
    std::map<long, int> table;
    for (const int system : divisors()) {
      for (const int own : divisors()) table.try_emplace(static_cast<long>(system) * own, system);
    }
    return table;
  }();
  return all;
}

LegalClock make_clock(const Board& board, long total, int system) {
  return {Hertz{board.master_clock.value / static_cast<double>(total)}, system,
          static_cast<int>(total / system)};
}

}  // namespace

Hertz ClockPlan::frequency(Hertz master, std::size_t clock) const {
  const ChipClock& chosen = clocks.at(clock);
  const int system = chosen.system == 1 ? sys1_divisor : sys2_divisor;
  return {master.value / (static_cast<double>(system) * chosen.divisor)};
}

bool is_legal_divisor(int divisor) {
  return divisor == 1 || (divisor >= 2 && divisor <= kLargestDivisor && divisor % 2 == 0);
}

int divisor_byte(int divisor) {
  return divisor == 1 ? 0 : divisor / 2;
}

std::optional<LegalClock> find_clock(const Board& board, Hertz frequency) {
  const LegalClock nearest = nearest_clock(board, frequency);
  if (std::abs(nearest.frequency.value / frequency.value - 1.0) > 1e-9) return std::nullopt;
  return nearest;
}

std::optional<int> common_system_divisor(std::span<const std::int64_t> totals) {
  const auto at = std::ranges::find_if(divisors(), [&](int system) {
    return std::ranges::all_of(totals, [&](std::int64_t total) {
      return total % system == 0 && total / system <= kLargestDivisor &&
             is_legal_divisor(static_cast<int>(total / system));
    });
  });
  return at == divisors().end() ? std::nullopt : std::optional(*at);
}

LegalClock nearest_clock(const Board& board, Hertz frequency) {
  const auto& table = total_divisors();
  const double total = board.master_clock.value / frequency.value;
  auto above = table.lower_bound(whole_number<long>(std::ceil(std::min(total, 1e9))));
  if (above == table.end()) above = std::prev(above);
  auto best = above;
  if (above != table.begin()) {
    const auto below = std::prev(above);
    if (total / static_cast<double>(below->first) < static_cast<double>(above->first) / total) best = below;
  }
  return make_clock(board, best->first, best->second);
}

}  // namespace bodesmith::fpaa
