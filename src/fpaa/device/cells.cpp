#include "fpaa/device/cells.hpp"

#include <stdexcept>

namespace bodesmith::fpaa::an231 {
namespace {

/// Whose op-amps stand behind selectors 9/8, B/A, D/C, F/E of CAB 1 to 4; 0: the direct lines.
constexpr std::array<std::array<int, 4>, kCabs> kBehindSelectors = {
    {{0, 3, 4, 2}, {0, 1, 3, 4}, {2, 1, 0, 4}, {2, 1, 3, 0}}};

constexpr int kFirstPair = 9;  ///< selectors 9/8 and two up each

int pair_of(int cab, int behind) {
  const auto& pairs = kBehindSelectors.at(static_cast<std::size_t>(cab - 1));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i] == behind) return static_cast<int>(i);
  }
  throw std::logic_error("no selector for this CAB");
}

}  // namespace

CircuitNode selected(int cab, int selector) {
  using Kind = CircuitNode::Kind;
  // The odd selector of a pair is number 1.
  const int number = selector % 2 == 1 ? 1 : 2;
  switch (selector / 2) {
    case 0:
      return {selector == kNearGround ? Kind::ground : Kind::open, 0, 0};
    case 1:
      return {Kind::opamp, cab, number};
    case 2:
      return {Kind::reference, 0, number == 1 ? 1 : -1};
    case 3:
      return {Kind::local_input, 0, number};
    default:
      break;
  }
  const int behind =
      kBehindSelectors.at(static_cast<std::size_t>(cab - 1)).at(static_cast<std::size_t>(selector / 2 - 4));
  if (behind == 0) return {Kind::direct_line, 0, number};
  return {Kind::opamp, behind, number};
}

int opamp_selector(int cab, int source_cab, int opamp) {
  const int first = cab == source_cab ? 3 : kFirstPair + 2 * pair_of(cab, source_cab);
  return first - (opamp - 1);
}

int local_input_selector(int input) {
  return 7 - (input - 1);
}

int direct_line_selector(int cab, int line) {
  return kFirstPair + 2 * pair_of(cab, 0) - (line - 1);
}

}  // namespace bodesmith::fpaa::an231
