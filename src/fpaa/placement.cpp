#include "fpaa/placement.hpp"

#include <fmt/format.h>

#include <optional>

namespace bodesmith::fpaa {
namespace {

/// What of a chip is taken.
class ChipRoom {
 public:
  explicit ChipRoom(const Board& board)
      : board_(board), used_(static_cast<std::size_t>(board.cabs_per_chip)) {}

  /// Takes the first CAB that has room (counted from 1); nothing when none has.
  std::optional<int> take(const Resources& cam) {
    if (tables_ + cam.lookup_tables > board_.lookup_tables_per_chip) return std::nullopt;
    Resources in_cab = cam;
    in_cab.lookup_tables = 0;  // the look-up table belongs to the chip, not to a CAB
    int cab = 0;
    for (Resources& used : used_) {
      ++cab;
      Resources total = used;
      total += in_cab;
      if (!total.fits_in(board_.per_cab)) continue;
      used = total;
      tables_ += cam.lookup_tables;
      return cab;
    }
    return std::nullopt;
  }

 private:
  const Board& board_;
  std::vector<Resources> used_;  ///< of each CAB
  int tables_ = 0;
};

}  // namespace

Outcome<std::vector<Place>> place_in_order(const std::vector<Resources>& cams, const Board& board) {
  std::vector<Place> out;
  int chip = 1;
  std::optional<ChipRoom> room(board);
  for (const Resources& cam : cams) {
    std::optional<int> cab = room->take(cam);
    if (!cab && chip < board.chips) {
      ++chip;
      room.emplace(board);
      cab = room->take(cam);
    }
    if (!cab) {
      return Refusal{fmt::format(
          "the design needs {} CAMs, {} of them fit on the {} chips of {}; expected fewer sections (a lower "
          "--order, or --max-error-db), or the rest made with spice",
          cams.size(), out.size(), board.chips, board.name)};
    }
    out.push_back({chip, *cab});
  }
  return out;
}

}  // namespace bodesmith::fpaa
