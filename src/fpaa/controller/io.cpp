#include "fpaa/controller/io.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/assembly.hpp"

namespace bodesmith::fpaa {
namespace {

std::vector<WiredCam> wired_cams(const ControllerVariant& variant) {
  return {variant.cams.begin(), variant.cams.end()};
}

/// What parts outside read, then the drive.
std::vector<std::string> leaving(const ControllerVariant& variant) {
  std::vector<std::string> out;
  for (const OutsidePart& part : variant.outside)
    out.insert(out.end(), part.inputs.begin(), part.inputs.end());
  out.push_back(variant.drive);
  return out;
}

}  // namespace

void check_controller_io(ControllerVariant& variant) {
  const Board& board = board_by_name(variant.board);
  for (const ChipSignals& chip : chip_signals(wired_cams(variant), leaving(variant), board))
    variant.io_cells.push_back(chip.pins());
  for (std::size_t chip = 0; chip < variant.io_cells.size(); ++chip) {
    if (variant.io_cells[chip] <= kIoCells) continue;
    throw DesignError(fmt::format(
        "chip {} needs {} I/O cells and has {}; expected fewer signals from outside (the polynomial by "
        "look-up needs only x), or a compensator of fewer sections so that a branch stays on one chip",
        chip + 1, variant.io_cells[chip], kIoCells));
  }
  for (const ControllerCam& cam : variant.cams) {
    const int ratio = cam.cam->facts().clock_b_ratio;
    const Hertz clock_b{ratio * cam.clock_a.value};
    if (ratio == 0 || find_clock(board, clock_b)) continue;
    throw DesignError(fmt::format(
        "{} ({}) needs ClockB = {} Hz, which is not in the clock tree; expected a fast clock of at most {} Hz",
        cam.name, cam.cam->name(), rounded_text(clock_b.value),
        rounded_text(board.master_clock.value / ratio)));
  }
  for (const ChipPlan& chip : controller_plan(variant).chips) {
    if (chip.clocks.clocks.size() <= kClocks) continue;
    throw DesignError(fmt::format("chip {} needs {} clocks and has {}; expected compensators of fewer clocks",
                                  chip.chip, chip.clocks.clocks.size(), kClocks));
  }
}

Plan controller_plan(const ControllerVariant& variant) {
  return assembled(wired_cams(variant), leaving(variant), board_by_name(variant.board), false);
}

std::map<std::string, std::string> pin_signals(const ControllerVariant& variant) {
  std::map<std::string, std::string> out;
  const std::vector<std::string> outside = leaving(variant);
  int chip = 0;
  for (const ChipSignals& signals :
       chip_signals(wired_cams(variant), outside, board_by_name(variant.board))) {
    ++chip;
    for (std::size_t i = 0; i < signals.in.size(); ++i) {
      if (variant.find(signals.in[i]) == nullptr)
        out[fmt::format("chip{}.in{}", chip, i + 1)] = signals.in[i];
    }
    for (std::size_t i = 0; i < signals.out.size(); ++i) {
      const std::string& name = signals.out[i];
      if (std::ranges::find(outside, name) != outside.end())
        out[fmt::format("chip{}.out{}", chip, i + 1)] = name == variant.drive ? "v" : name;
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
