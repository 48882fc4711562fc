#include "fpaa/search/plan_of_design.hpp"

#include <fmt/format.h>

#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/assembly.hpp"

namespace bodesmith::fpaa {

Outcome<Plan> plan_of_design(const Design& design, const Board& board) {
  std::vector<PlaceNeed> needs;
  for (const DesignStage& stage : design.stages)
    needs.push_back({stage.resources(), static_cast<int>(needs.size()), stage.divisor});
  const Outcome<std::vector<Place>> placed = place(needs, board);
  if (const Refusal* refusal = refusal_of(placed)) return *refusal;
  std::vector<WiredCam> cams;
  for (const DesignStage& stage : design.stages) {
    const Place& at = std::get<std::vector<Place>>(placed)[cams.size()];
    WiredCam made;
    made.name = stage.name;
    made.clock_a = {board.master_clock.value / static_cast<double>(stage.divisor)};
    for (const Cam* cam : cam_registry().all()) {
      if (cam->place(stage, made)) break;
    }
    made.chip = at.chip;
    made.cab = at.cab;
    for (const int from : stage.from)
      made.inputs.push_back(from < 0 ? "in" : design.stages[static_cast<std::size_t>(from)].name);
    cams.push_back(std::move(made));
  }
  const std::vector<std::string> leaving{cams.back().name};
  int chip = 0;
  for (const ChipSignals& signals : chip_signals(cams, leaving, board)) {
    ++chip;
    if (signals.pins() <= board.io_cells_per_chip) continue;
    return Refusal{fmt::format("chip {} would need {} pins, it has {}; expected fewer poles (a lower order)",
                               chip, signals.pins(), board.io_cells_per_chip)};
  }
  return assembled(cams, leaving, board, true);
}

}  // namespace bodesmith::fpaa
