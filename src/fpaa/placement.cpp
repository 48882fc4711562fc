#include "fpaa/placement.hpp"

#include <fmt/format.h>

#include "base/error.hpp"

namespace bodesmith::fpaa {

std::vector<Place> place_in_order(const std::vector<Resources>& cams, const Board& board) {
  std::vector<Place> out;
  int chip = 1;
  std::vector<Resources> used(static_cast<size_t>(board.cabs_per_chip));
  int tables = 0;
  for (size_t i = 0; i < cams.size(); ++i) {
    Resources in_cab = cams[i];
    in_cab.lookup_tables = 0;  // the look-up table belongs to the chip, not to a CAB
    const auto find_cab = [&]() -> int {
      if (tables + cams[i].lookup_tables > board.lookup_tables_per_chip) return 0;
      for (int cab = 1; cab <= board.cabs_per_chip; ++cab) {
        Resources total = used[static_cast<size_t>(cab - 1)];
        total += in_cab;
        if (total.fits_in(board.per_cab)) return cab;
      }
      return 0;
    };
    int cab = find_cab();
    if (cab == 0) {
      ++chip;
      used.assign(used.size(), {});
      tables = 0;
      cab = chip <= board.chips ? find_cab() : 0;
      if (cab == 0) {
        throw DesignError(
            fmt::format("the design needs {} CAMs, {} of them fit on the {} chips of {}; expected fewer "
                        "sections (a lower "
                        "--order, or --max-error-db), or the rest made with spice",
                        cams.size(), i, board.chips, board.name));
      }
    }
    used[static_cast<size_t>(cab - 1)] += in_cab;
    tables += cams[i].lookup_tables;
    out.push_back({chip, cab});
  }
  return out;
}

}  // namespace bodesmith::fpaa
