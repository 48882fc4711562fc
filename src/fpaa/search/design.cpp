#include "fpaa/search/design.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/assembly.hpp"

#include <fmt/format.h>
#include <cmath>

namespace bodesmith::fpaa {

bool DesignStage::is_free(std::size_t capacitor) const {
  if (whole || !(c[capacitor] > 0.0)) return false;
  if (is_first()) return capacitor != 2 * from.size();
  return capacitor != kC3 && capacitor != kCA && capacitor != kCB;
}

int Design::opamps() const {
  int out = 0;
  for (const DesignStage& stage : stages) out += stage.opamps();
  return out;
}

void Design::scale_node(std::size_t stage, double factor) {
  for (std::size_t s = stage; s < stages.size(); ++s) {
    DesignStage& at = stages[s];
    for (std::size_t i = 0; i < at.c.size(); ++i) {
      const int input = at.input_of(i);
      if (input < 0) continue;
      if (s == stage) {
        at.c[i] *= factor;
      } else if (at.from[static_cast<std::size_t>(input)] == static_cast<int>(stage)) {
        at.c[i] /= factor;
      }
    }
  }
}

double snapped(double value) {
  constexpr int kBits = 20;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, kBits)), exponent - kBits);
}

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
    if (signals.pins() <= kIoCells) continue;
    return Refusal{fmt::format("chip {} would need {} pins, it has {}; expected fewer poles (a lower order)",
                               chip, signals.pins(), kIoCells)};
  }
  return assembled(cams, leaving, board, true);
}

}  // namespace bodesmith::fpaa
