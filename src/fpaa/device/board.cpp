#include "fpaa/device/board.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace bodesmith::fpaa {

Resources& Resources::operator+=(const Resources& other) {
  opamps += other.opamps;
  capacitors += other.capacitors;
  comparators += other.comparators;
  sars += other.sars;
  lookup_tables += other.lookup_tables;
  return *this;
}

bool Resources::fits_in(const Resources& available) const {
  return opamps <= available.opamps && capacitors <= available.capacitors &&
         comparators <= available.comparators && sars <= available.sars &&
         lookup_tables <= available.lookup_tables;
}

const Board& an231k04_quad4() {
  static const Board board = [] {
    Board b;
    b.name = "an231k04-quad4";
    b.chip = "AN231E04";
    b.chips = 4;
    return b;
  }();
  return board;
}

const std::vector<const Board*>& boards() {
  static const std::vector<const Board*> all = {&an231k04_quad4()};
  return all;
}

Outcome<const Board*> find_board(std::string_view name) {
  std::vector<std::string> names;
  for (const Board* board : boards()) {
    if (board->name == name) return board;
    names.push_back(board->name);
  }
  return Refusal{fmt::format("'{}' is not a board that is known{}, expected one of: {}", name,
                             did_you_mean(name, names), join(names, ", "))};
}

const Board& board_by_name(std::string_view name) {
  return *value_or_throw(find_board(name));
}

}  // namespace bodesmith::fpaa
