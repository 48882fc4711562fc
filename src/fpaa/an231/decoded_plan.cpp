#include "fpaa/an231/decoded_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

using Kind = CircuitNode::Kind;

std::string opamp_name(const BoardNode& amp) {
  return fmt::format("CAB{}op{}", amp.node.cab, amp.node.number);
}

class PlanDecoder {
 public:
  PlanDecoder(const BoardCircuit& board, BoardPin from, BoardPin to)
      : board_(board), from_(from), to_(to), stages_(stage_transfers(board)) {}

  Outcome<Plan> decode() {
    start();
    const auto chip = chip_index(to_.chip);
    if (!chip || !chip_index(from_.chip)) return Refusal{"there is no stream for one of the chips"};
    const IoCell& cell = board_.chips[*chip].cell(to_.cell);
    if (!cell.is_output()) return Refusal{fmt::format("chip{}.IO{} is no output", to_.chip, to_.cell)};
    const std::string out = fmt::format("chip{}.out{}", to_.chip, to_.cell);
    wire({*chip, cell.source}, out, 1);
    while (!todo_.empty()) {
      const BoardNode amp = todo_.back();
      todo_.pop_back();
      if (auto refusal = add(amp)) return *refusal;
    }
    return std::move(plan_);
  }

 private:
  std::optional<std::size_t> chip_index(int address) const {
    for (std::size_t i = 0; i < board_.chips.size(); ++i) {
      if (board_.chips[i].address1 == address) return i;
    }
    return std::nullopt;
  }

  void start() {
    plan_.board = an231k04_quad4().name;
    for (const ChipCircuit& chip : board_.chips) {
      ChipPlan out;
      out.chip = chip.address1;
      out.master_clock = board_.master;
      plan_.chips.push_back(std::move(out));
    }
  }

  /// A wire from a node, followed out of the chip; none from what is always zero.
  void wire(BoardNode from, const std::string& to, int input) {
    if (from.node.kind == Kind::pin) {
      if (const auto linked = behind_link(board_, from.chip, from.node.number)) from = linked->node;
    }
    const int address = board_.chips[from.chip].address1;
    if (from.node.kind == Kind::opamp) {
      plan_.wires.push_back({fmt::format("chip{}.{}", address, opamp_name(from)), to, input});
      if (seen_.insert(plan_.wires.back().from).second) todo_.push_back(from);
    } else if (from.node.kind == Kind::pin && address == from_.chip && from.node.number == from_.cell) {
      plan_.wires.push_back({fmt::format("chip{}.in{}", address, from_.cell), to, input});
    }
  }

  std::optional<Refusal> add(const BoardNode& amp) {
    const auto stage =
        std::find_if(stages_.begin(), stages_.end(), [&](const StageTransfer& s) { return s.opamp == amp; });
    const std::string name = fmt::format("chip{}.{}", board_.chips[amp.chip].address1, opamp_name(amp));
    if (stage == stages_.end()) return Refusal{fmt::format("{} has no capacitors", name)};
    if (!stage->obstacle.empty()) return Refusal{fmt::format("{}: {}", name, stage->obstacle)};
    PlacedCam cam;
    cam.name = opamp_name(amp);
    cam.cam = cam_registry().find("GainInv");
    cam.cab = amp.node.cab;
    cam.clock_a = {board_.master.value / std::max(stage->clock_divisor, 1)};
    cam.phase = stage->phase;
    cam.delay_cycles = stage->phase == 2 ? 0.5 : 0.0;
    cam.z.denominator = stage->denominator;
    cam.z.numerator = stage->inputs.empty() ? std::vector<double>{0.0} : stage->numerators[0];
    for (std::size_t i = 1; i < stage->inputs.size(); ++i)
      cam.more_numerators.push_back(stage->numerators[i]);
    for (std::size_t i = 0; i < stage->inputs.size(); ++i) {
      wire(stage->inputs[i], name, static_cast<int>(i) + 1);
    }
    plan_.chips[amp.chip].cams.push_back(std::move(cam));
    return std::nullopt;
  }

  const BoardCircuit& board_;
  BoardPin from_;
  BoardPin to_;
  std::vector<StageTransfer> stages_;
  std::set<std::string> seen_;
  std::vector<BoardNode> todo_;
  Plan plan_;
};

}  // namespace

Outcome<Plan> decoded_plan(const BoardCircuit& board, BoardPin from, BoardPin to) {
  return PlanDecoder(board, from, to).decode();
}

Outcome<SignalPins> signal_pins(const BoardCircuit& board) {
  std::vector<BoardPin> inputs;
  std::vector<BoardPin> outputs;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < board.chips.size(); ++i) {
    const ChipCircuit& chip = board.chips[i];
    for (const IoCell& cell : chip.cells) {
      const bool wired = std::any_of(board.links.begin(), board.links.end(), [&](const PinLink& l) {
        const bool from =
            static_cast<std::size_t>(l.from_chip) == i && l.from_cell == cell.number && cell.is_output();
        const bool to = static_cast<std::size_t>(l.to_chip) == i && l.to_cell == cell.number;
        return from || to;
      });
      if (wired || (!cell.is_input() && !cell.is_output())) continue;
      (cell.is_input() ? inputs : outputs).push_back({chip.address1, cell.number});
      names.push_back(fmt::format("chip{}.IO{} ({})", chip.address1, cell.number, to_string(cell.mode)));
    }
  }
  if (inputs.size() == 1 && outputs.size() == 1) return SignalPins{inputs[0], outputs[0]};
  return Refusal{
      fmt::format("the streams have {} input{} and {} output{} that no wire joins ({}); expected one of "
                  "each, or their names",
                  inputs.size(), inputs.size() == 1 ? "" : "s", outputs.size(),
                  outputs.size() == 1 ? "" : "s", join(names, ", "))};
}

}  // namespace bodesmith::fpaa::an231
