#include "fpaa/controller/io.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/device/clock_tree.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr std::size_t kMostClocks = 6;  ///< Clock 0 to 5 of a chip

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// "in2" for the second of the signals.
std::string pin(const char* kind, const std::vector<std::string>& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name) - names.begin();
  return fmt::format("{}{}", kind, at + 1);
}

/// All clocks from one system clock: each divides the master by an even number, or by 1.
ClockPlan clock_plan(const std::vector<Hertz>& clocks, const Board& board) {
  ClockPlan out;
  int shared = 0;
  for (const Hertz f : clocks) {
    const auto whole = nearest_whole<int>(board.master_clock.value / f.value);
    if (!is_legal_divisor(whole)) {
      // Not without a system divisor: the one that this clock needs serves all that are as slow.
      const auto legal = find_clock(board, f);
      shared = std::max(shared, legal ? legal->system_divisor : 1);
    }
  }
  out.sys2_divisor = std::max(1, shared);
  for (const Hertz f : clocks) {
    const auto whole = nearest_whole<int>(board.master_clock.value / f.value);
    const bool direct = is_legal_divisor(whole);
    out.clocks.push_back({direct ? 1 : 2, direct ? whole : whole / out.sys2_divisor});
  }
  return out;
}

}  // namespace

std::vector<ChipSignals> chip_signals(const ControllerVariant& variant) {
  const Board& board = board_by_name(variant.board);
  std::vector<ChipSignals> out(static_cast<std::size_t>(board.chips));
  const auto of = [&](int chip) -> ChipSignals& { return out[static_cast<std::size_t>(chip - 1)]; };
  for (const ControllerCam& cam : variant.cams) {
    for (const std::string& input : cam.inputs) {
      const ControllerCam* source = variant.find(input);
      if (source == nullptr || source->chip != cam.chip) add_once(of(cam.chip).in, input);
      if (source != nullptr && source->chip != cam.chip) add_once(of(source->chip).out, input);
    }
  }
  for (const OutsidePart& part : variant.outside) {
    for (const std::string& input : part.inputs) {
      if (const ControllerCam* source = variant.find(input)) add_once(of(source->chip).out, input);
    }
  }
  if (const ControllerCam* drive = variant.find(variant.drive)) add_once(of(drive->chip).out, variant.drive);
  return out;
}

std::vector<int> controller_io_cells(const ControllerVariant& variant) {
  std::vector<int> out;
  for (const ChipSignals& chip : chip_signals(variant))
    out.push_back(static_cast<int>(chip.in.size() + chip.out.size()));
  return out;
}

std::optional<Refusal> check_controller_io(const ControllerVariant& variant) {
  const Board& board = board_by_name(variant.board);
  int chip = 0;
  for (const int used : controller_io_cells(variant)) {
    ++chip;
    if (used <= board.io_cells_per_chip) continue;
    return Refusal{fmt::format(
        "chip {} needs {} I/O cells and has {}; expected fewer signals from outside (the polynomial by "
        "look-up needs only x), or a compensator of fewer sections so that a branch stays on one chip",
        chip, used, board.io_cells_per_chip)};
  }
  return std::nullopt;
}

std::vector<Hertz> chip_clocks(const ControllerVariant& variant, int chip) {
  std::vector<Hertz> out;
  const auto add = [&](Hertz f) {
    const bool known = std::any_of(out.begin(), out.end(),
                                   [&](Hertz g) { return std::abs(g.value - f.value) <= 1e-9 * f.value; });
    if (!known) out.push_back(f);
  };
  for (const ControllerCam& cam : variant.cams) {
    if (cam.chip != chip) continue;
    add(cam.clock_a);
    if (const int ratio = cam.cam->facts().clock_b_ratio) add({ratio * cam.clock_a.value});
  }
  std::sort(out.begin(), out.end(), [](Hertz f, Hertz g) { return f.value > g.value; });
  // Converters: the two clocks once more as Clock 2 and 3, which public streams give them.
  const bool converter = std::any_of(variant.cams.begin(), variant.cams.end(), [&](const ControllerCam& cam) {
    return cam.chip == chip && cam.cam->facts().clock_b_ratio != 0;
  });
  if (converter && out.size() == 2) out = {out[0], out[1], out[0], out[1]};
  return out;
}

std::optional<Refusal> check_controller_clocks(const ControllerVariant& variant) {
  const Board& board = board_by_name(variant.board);
  for (const ControllerCam& cam : variant.cams) {
    const int ratio = cam.cam->facts().clock_b_ratio;
    const Hertz clock_b{ratio * cam.clock_a.value};
    if (ratio == 0 || find_clock(board, clock_b)) continue;
    return Refusal{fmt::format(
        "{} ({}) needs ClockB = {} Hz, which is not in the clock tree; expected a fast clock of at most {} Hz",
        cam.name, cam.cam->name(), rounded_text(clock_b.value),
        rounded_text(board.master_clock.value / ratio))};
  }
  for (int chip = 1; chip <= board.chips; ++chip) {
    const std::size_t count = chip_clocks(variant, chip).size();
    if (count <= kMostClocks) continue;
    return Refusal{fmt::format("chip {} needs {} clocks and has {}; expected compensators of fewer clocks",
                               chip, count, kMostClocks)};
  }
  return std::nullopt;
}

Plan controller_plan(const ControllerVariant& variant) {
  const Board& board = board_by_name(variant.board);
  const std::vector<ChipSignals> signals = chip_signals(variant);
  Plan plan;
  plan.board = variant.board;
  for (int chip = 1; chip <= variant.chips; ++chip) {
    ChipPlan made;
    made.chip = chip;
    made.master_clock = board.master_clock;
    const std::vector<Hertz> clocks = chip_clocks(variant, chip);
    made.clocks = clock_plan(clocks, board);
    for (const ControllerCam& cam : variant.cams) {
      if (cam.chip != chip) continue;
      made.cams.push_back(cam);
      for (std::size_t k = 0; k < clocks.size(); ++k) {
        if (std::abs(clocks[k].value - cam.clock_a.value) <= 1e-9 * clocks[k].value)
          made.cams.back().clock_index = static_cast<int>(k);
      }
    }
    plan.chips.push_back(std::move(made));
  }
  const auto at = [&](const std::string& name, int chip) { return fmt::format("chip{}.{}", chip, name); };
  const auto of = [&](int chip) -> const ChipSignals& { return signals[static_cast<std::size_t>(chip - 1)]; };
  for (const ControllerCam& cam : variant.cams) {
    for (const std::string& name : of(cam.chip).out) {
      if (name == cam.name)
        plan.wires.push_back({at(name, cam.chip), at(pin("out", of(cam.chip).out, name), cam.chip)});
    }
    int input = 0;
    for (const std::string& name : cam.inputs) {
      const ControllerCam* source = variant.find(name);
      const bool inside = source != nullptr && source->chip == cam.chip;
      plan.wires.push_back({inside ? at(name, cam.chip) : at(pin("in", of(cam.chip).in, name), cam.chip),
                            at(cam.name, cam.chip), ++input});
    }
  }
  for (int chip = 1; chip <= variant.chips; ++chip) {
    for (const std::string& name : of(chip).in) {
      const ControllerCam* source = variant.find(name);
      if (source == nullptr) continue;
      plan.wires.push_back(
          {at(pin("out", of(source->chip).out, name), source->chip), at(pin("in", of(chip).in, name), chip)});
    }
  }
  return plan;
}

std::map<std::string, std::string> pin_signals(const ControllerVariant& variant) {
  std::map<std::string, std::string> out;
  int chip = 0;
  for (const ChipSignals& signals : chip_signals(variant)) {
    ++chip;
    for (const std::string& name : signals.in) {
      if (variant.find(name) == nullptr)
        out[fmt::format("chip{}.{}", chip, pin("in", signals.in, name))] = name;
    }
    for (const std::string& name : signals.out) {
      const bool drive = name == variant.drive;
      const bool outside =
          std::any_of(variant.outside.begin(), variant.outside.end(), [&](const OutsidePart& p) {
            return std::find(p.inputs.begin(), p.inputs.end(), name) != p.inputs.end();
          });
      if (drive || outside)
        out[fmt::format("chip{}.{}", chip, pin("out", signals.out, name))] = drive ? "v" : name;
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
