#include "fpaa/search/plan_of_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr std::size_t kClocksOfChip = 6;

/// What of one chip is taken.
struct DesignRoom {
  std::vector<Resources> cabs;
  std::vector<std::int64_t> divisors;  ///< Clock 0, 1, …
  std::set<std::string> entering, leaving;
};

/// Places stages one after the other.
class DesignPlacer {
 public:
  DesignPlacer(const Design& design, const Board& board)
      : design_(design), board_(board), chip_of_(design.stages.size(), -1), cab_of_(design.stages.size(), 0) {
    rooms_.resize(static_cast<std::size_t>(board.chips));
    for (DesignRoom& room : rooms_) room.cabs.resize(static_cast<std::size_t>(board.cabs_per_chip));
  }

  Outcome<Plan> run() {
    for (std::size_t s = 0; s < design_.stages.size(); ++s) {
      if (!place(s)) return refusal();
    }
    Plan out;
    out.board = board_.name;
    if (!add_chips(out)) return Refusal{"no clock tree of one chip makes the clocks of this design"};
    add_wires(out);
    if (auto why = pins_refusal()) return *why;
    find_path(out);
    return out;
  }

 private:
  /// The chip of what it reads, those behind it, then all: one path goes from chip to chip once.
  std::vector<int> preferred_chips(std::size_t s) const {
    int before = 0;
    for (const int from : design_.stages[s].from) {
      if (from >= 0) before = std::max(before, chip_of_[static_cast<std::size_t>(from)]);
    }
    std::vector<int> out;
    for (int chip = before; chip < board_.chips; ++chip) out.push_back(chip);
    for (int chip = 0; chip < before; ++chip) out.push_back(chip);
    return out;
  }

  bool place(std::size_t s) {
    const DesignStage& stage = design_.stages[s];
    const Resources need = stage.resources();
    for (const int chip : preferred_chips(s)) {
      DesignRoom& room = rooms_[static_cast<std::size_t>(chip)];
      const bool known =
          std::find(room.divisors.begin(), room.divisors.end(), stage.divisor) != room.divisors.end();
      if (!known && room.divisors.size() >= kClocksOfChip) continue;
      if (!known) {
        std::vector<std::int64_t> with = room.divisors;
        with.push_back(stage.divisor);
        if (!common_system_divisor(with)) continue;
      }
      if (!take_cab(room, need, cab_of_[s])) continue;
      if (!known) room.divisors.push_back(stage.divisor);
      chip_of_[s] = chip;
      return true;
    }
    return false;
  }

  /// The fullest CAB that has room.
  bool take_cab(DesignRoom& room, const Resources& need, int& cab) const {
    int best = -1;
    for (std::size_t i = 0; i < room.cabs.size(); ++i) {
      Resources total = room.cabs[i];
      total += need;
      if (!total.fits_in(board_.per_cab)) continue;
      if (best < 0 || room.cabs[i].capacitors > room.cabs[static_cast<std::size_t>(best)].capacitors) {
        best = static_cast<int>(i);
      }
    }
    if (best < 0) return false;
    room.cabs[static_cast<std::size_t>(best)] += need;
    cab = best + 1;
    return true;
  }

  Refusal refusal() const {
    const auto placed = std::count_if(chip_of_.begin(), chip_of_.end(), [](int chip) { return chip >= 0; });
    return {fmt::format(
        "the design needs {} CAMs with {} op-amps, {} of them fit on the {} chips of {}; expected fewer poles (a "
        "lower order, or a larger error), or the rest made with spice",
        design_.stages.size(), design_.opamps(), placed, board_.chips, board_.name)};
  }

  PlacedCam placed(const DesignStage& stage) const {
    PlacedCam out;
    out.name = stage.name;
    out.clock_a = {board_.master_clock.value / static_cast<double>(stage.divisor)};
    for (const Cam* cam : cam_registry().all()) {
      if (cam->place(stage, out)) break;
    }
    return out;
  }

  bool add_chips(Plan& out) const {
    for (int chip = 0; chip < board_.chips; ++chip) {
      const DesignRoom& room = rooms_[static_cast<std::size_t>(chip)];
      if (room.divisors.empty()) continue;
      ChipPlan plan;
      plan.chip = chip + 1;
      plan.master_clock = board_.master_clock;
      const std::optional<int> system = common_system_divisor(room.divisors);
      if (!system) return false;
      plan.clocks = {*system, *system, {}};
      for (const std::int64_t total : room.divisors)
        plan.clocks.clocks.push_back({1, static_cast<int>(total / *system)});
      for (std::size_t s = 0; s < design_.stages.size(); ++s) {
        if (chip_of_[s] != chip) continue;
        PlacedCam cam = placed(design_.stages[s]);
        cam.cab = cab_of_[s];
        const auto clock = std::find(room.divisors.begin(), room.divisors.end(), design_.stages[s].divisor);
        cam.clock_index = static_cast<int>(clock - room.divisors.begin());
        plan.cams.push_back(std::move(cam));
      }
      out.chips.push_back(std::move(plan));
    }
    return true;
  }

  std::string cam_name(std::size_t s) const {
    return fmt::format("chip{}.{}", chip_of_[s] + 1, design_.stages[s].name);
  }

  std::string new_pin(int chip, const char* kind) {
    DesignRoom& room = rooms_[static_cast<std::size_t>(chip)];
    std::set<std::string>& pins = std::string(kind) == "in" ? room.entering : room.leaving;
    std::string name = fmt::format("chip{}.{}{}", chip + 1, kind, pins.size() + 1);
    pins.insert(name);
    return name;
  }

  /// The name under which `chip` knows the output of a stage (or the board's input): wires the way to it.
  std::string known_as(int from, int chip, Plan& out) {
    if (from >= 0 && chip_of_[static_cast<std::size_t>(from)] == chip) {
      return cam_name(static_cast<std::size_t>(from));
    }
    const auto key = std::pair(from, chip);
    if (const auto at = entry_.find(key); at != entry_.end()) return at->second;
    std::string leaving;
    if (from < 0) {
      leaving = chip == 0 ? "" : known_as(from, 0, out);
    } else {
      std::string& pin = exit_[from];
      if (pin.empty()) {
        pin = new_pin(chip_of_[static_cast<std::size_t>(from)], "out");
        out.wires.push_back({cam_name(static_cast<std::size_t>(from)), pin});
      }
      leaving = pin;
    }
    const std::string pin = new_pin(chip, "in");
    if (!leaving.empty()) out.wires.push_back({leaving, pin});
    entry_[key] = pin;
    return pin;
  }

  void add_wires(Plan& out) {
    known_as(DesignStage::kBoardInput, 0, out);  // the board's input is chip1.in1
    for (std::size_t s = 0; s < design_.stages.size(); ++s) {
      const DesignStage& stage = design_.stages[s];
      for (std::size_t i = 0; i < stage.from.size(); ++i) {
        const std::string from = known_as(stage.from[i], chip_of_[s], out);
        out.wires.push_back({from, cam_name(s), static_cast<int>(i) + 1});
      }
    }
    const std::size_t last = design_.stages.size() - 1;
    output_ = new_pin(chip_of_[last], "out");
    out.wires.push_back({cam_name(last), output_});
  }

  std::optional<Refusal> pins_refusal() const {
    for (int chip = 0; chip < board_.chips; ++chip) {
      const DesignRoom& room = rooms_[static_cast<std::size_t>(chip)];
      const std::size_t pins = room.entering.size() + room.leaving.size();
      if (pins > static_cast<std::size_t>(board_.io_cells_per_chip)) {
        return Refusal{
            fmt::format("chip {} would need {} pins, it has {}; expected fewer poles (a lower order)",
                        chip + 1, pins, board_.io_cells_per_chip)};
      }
    }
    return std::nullopt;
  }

  /// The shortest way from the input to the output: that of the constant path where there is one.
  void find_path(Plan& out) const {
    std::map<std::string, std::string> reached_from{{"chip1.in1", ""}};
    std::vector<std::string> front{"chip1.in1"};
    while (!front.empty() && reached_from.count(output_) == 0) {
      std::vector<std::string> next;
      for (const std::string& name : front) {
        for (const Wire& wire : out.wires) {
          if (wire.from == name && reached_from.emplace(wire.to, name).second) next.push_back(wire.to);
        }
      }
      front = std::move(next);
    }
    for (std::string at = output_; !at.empty() && reached_from.count(at) != 0; at = reached_from[at]) {
      out.path.insert(out.path.begin(), at);
    }
  }

  const Design& design_;
  const Board& board_;
  std::vector<DesignRoom> rooms_;
  std::vector<int> chip_of_;  ///< from 0
  std::vector<int> cab_of_;   ///< from 1
  std::map<std::pair<int, int>, std::string> entry_;
  std::map<int, std::string> exit_;
  std::string output_;
};

}  // namespace

Outcome<Plan> plan_of_design(const Design& design, const Board& board) {
  return DesignPlacer(design, board).run();
}

}  // namespace bodesmith::fpaa
