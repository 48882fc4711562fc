#include "fpaa/controller/placement.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>

namespace bodesmith::fpaa {
namespace {

/// What of a chip is taken.
class ChipRoom {
 public:
  explicit ChipRoom(const Board& board)
      : board_(&board), used_(static_cast<std::size_t>(board.cabs_per_chip)) {}

  /// Takes the first CAB that has room (counted from 1); nothing when none has.
  std::optional<int> take(const Resources& cam) {
    if (tables_ + cam.lookup_tables > board_->lookup_tables_per_chip) return std::nullopt;
    Resources in_cab = cam;
    in_cab.lookup_tables = 0;  // the look-up table belongs to the chip, not to a CAB
    int cab = 0;
    for (Resources& used : used_) {
      ++cab;
      Resources total = used;
      total += in_cab;
      if (!total.fits_in(board_->per_cab)) continue;
      used = total;
      tables_ += cam.lookup_tables;
      return cab;
    }
    return std::nullopt;
  }

 private:
  const Board* board_;
  std::vector<Resources> used_;  ///< of each CAB
  int tables_ = 0;
};

/// Every CAM of the list on this chip, or nothing and the chip as it was.
std::optional<std::vector<int>> take_all(ChipRoom& room, const std::vector<Resources>& cams,
                                         const std::vector<std::size_t>& which) {
  ChipRoom trial = room;
  std::vector<int> out;
  for (const std::size_t i : which) {
    const std::optional<int> cab = trial.take(cams[i]);
    if (!cab) return std::nullopt;
    out.push_back(*cab);
  }
  room = trial;
  return out;
}

Refusal too_many(std::size_t cams, std::size_t placed, const Board& board) {
  return {fmt::format(
      "the design needs {} CAMs, {} of them fit on the {} chips of {}; expected fewer sections (a lower "
      "order, or a larger error), or the rest made with spice",
      cams, placed, board.chips, board.name)};
}

}  // namespace

Outcome<std::vector<Place>> place_groups(const std::vector<Resources>& cams, const std::vector<int>& groups,
                                         const Board& board) {
  std::map<int, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < cams.size(); ++i) members[groups[i]].push_back(i);
  std::vector<Place> out(cams.size());
  std::size_t placed = 0;
  int chip = 1;
  ChipRoom room(board);
  const auto next_chip = [&] {
    ++chip;
    room = ChipRoom(board);
  };
  for (const auto& [group, which] : members) {
    auto cabs = take_all(room, cams, which);
    ChipRoom fresh(board);
    if (!cabs && chip < board.chips && take_all(fresh, cams, which)) {
      next_chip();
      cabs = take_all(room, cams, which);
    }
    for (std::size_t k = 0; k < which.size(); ++k) {
      std::optional<int> cab = cabs ? std::optional<int>((*cabs)[k]) : room.take(cams[which[k]]);
      if (!cab && chip < board.chips) {
        next_chip();
        cab = room.take(cams[which[k]]);
      }
      if (!cab) return too_many(cams.size(), placed, board);
      out[which[k]] = {chip, *cab};
      ++placed;
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
