#include "fpaa/streams/pin_networks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/text.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

using Kind = CircuitNode::Kind;
using Source = PeriodicNetworks::Source;

/// A node behind the wires outside the chips.
LinkedSource behind_wires(const BoardCircuit& board, const BoardNode& node) {
  if (node.node.kind == Kind::pin) {
    if (const auto linked = behind_link(board, node.chip, node.node.number)) return *linked;
  }
  return {node, 0};
}

/// Capacitors that act on an op-amp's inverting input.
std::vector<const CapacitorCell*> capacitors_at(const BoardCircuit& board, const BoardNode& amp) {
  const CircuitNode ground{Kind::virtual_ground, amp.node.cab, amp.node.number};
  std::vector<const CapacitorCell*> out;
  for (const CapacitorCell& c : board.chips[amp.chip].cab(amp.node.cab).capacitors) {
    if (c.far.at[0] == ground || c.far.at[1] == ground) out.push_back(&c);
  }
  return out;
}

std::vector<BoardNode> opamps_read_by(const BoardCircuit& board, const BoardNode& amp) {
  std::vector<BoardNode> out;
  for (const CapacitorCell* c : capacitors_at(board, amp)) {
    for (const CircuitNode& near : c->near.at) {
      const LinkedSource source = behind_wires(board, {amp.chip, near});
      if (source.node.node.kind == Kind::opamp && source.sampled_phase == 0) out.push_back(source.node);
    }
  }
  return out;
}

bool contains(const std::vector<BoardNode>& list, const BoardNode& node) {
  return std::find(list.begin(), list.end(), node) != list.end();
}

std::vector<BoardNode> all_read_by(const BoardCircuit& board, const BoardNode& amp) {
  std::vector<BoardNode> out = opamps_read_by(board, amp);
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (const BoardNode& more : opamps_read_by(board, out[i])) {
      if (!contains(out, more)) out.push_back(more);
    }
  }
  return out;
}

/// The op-amp and those that it reads and that read it.
std::vector<BoardNode> loop_of(const BoardCircuit& board, const BoardNode& amp) {
  std::vector<BoardNode> out{amp};
  for (const BoardNode& other : all_read_by(board, amp)) {
    if (!contains(out, other) && contains(all_read_by(board, other), amp)) out.push_back(other);
  }
  return out;
}

/// One loop of op-amps as a network.
class LoopNetwork {
 public:
  LoopNetwork(const BoardCircuit& board, std::vector<BoardNode> members)
      : board_(board), members_(std::move(members)) {
    for (std::size_t i = 0; i < members_.size(); ++i)
      network.opamps.push_back({.plus = 0, .minus = network.add_node(), .out = network.add_node()});
  }

  std::optional<Refusal> build() {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const BoardNode& amp = members_[i];
      for (const CapacitorCell* c : capacitors_at(board_, amp)) {
        // Of two op-amps' capacitor the first has it.
        if (std::find(placed_.begin(), placed_.end(), c) != placed_.end()) continue;
        placed_.push_back(c);
        if (!c->is_understood)
          return Refusal{
              fmt::format("C{} of CAB {} has switches that are not understood", c->number, amp.node.cab)};
        const int near = plate(amp, c->near);
        const int far = plate(amp, c->far);
        network.capacitors.push_back(
            {fmt::format("C{}", c->number), near, far, static_cast<double>(c->units)});
      }
      const OpAmpCell& cell =
          board_.chips[amp.chip].cab(amp.node.cab).opamps[static_cast<std::size_t>(amp.node.number - 1)];
      if (!cell.on) return Refusal{fmt::format("op-amp {} of CAB {} is off", amp.node.number, amp.node.cab)};
      if (cell.reset_phase != 0)
        network.switches.push_back(
            {network.opamps[i].minus, network.opamps[i].out, clock(amp, cell.reset_clock), cell.reset_phase});
    }
    if (missing_clock_) return Refusal{"a switch is moved by a clock that the chip does not have"};
    if (periods.empty()) periods.push_back(2);  // nothing switches: any clock will do
    return std::nullopt;
  }

  SwitchedNetwork network;
  std::vector<std::int64_t> periods;
  std::vector<LinkedSource> sources;  ///< of each input

 private:
  /// Index of a CAB's clock; half periods of the master clock are the ticks.
  int clock(const BoardNode& amp, SwitchWord::Clock by) {
    const ChipCircuit& chip = board_.chips[amp.chip];
    const std::optional<int> number = chip.cab(amp.node.cab).clock(by);
    if (!number) {
      missing_clock_ = true;
      return 0;
    }
    const std::int64_t period =
        std::int64_t{2} * chip.system1_divisor * chip.divisors[static_cast<std::size_t>(*number)];
    const auto at = std::find(periods.begin(), periods.end(), period);
    if (at != periods.end()) return static_cast<int>(at - periods.begin());
    periods.push_back(period);
    return static_cast<int>(periods.size()) - 1;
  }

  int plate(const BoardNode& amp, const SwitchWord& word) {
    if (word.clock == SwitchWord::Clock::none && word.at[0].kind != Kind::open) return node(amp, word.at[0]);
    const int own = network.add_node();
    if (word.clock == SwitchWord::Clock::none) return own;
    for (int phase = 1; phase <= 2; ++phase) {
      const CircuitNode& end = word.at[static_cast<std::size_t>(phase - 1)];
      if (end.kind != Kind::open)
        network.switches.push_back({own, node(amp, end), clock(amp, word.clock), phase});
    }
    return own;
  }

  int node(const BoardNode& amp, const CircuitNode& at) {
    if (at.kind == Kind::virtual_ground) return member({amp.chip, {Kind::opamp, at.cab, at.number}}, false);
    if (at.kind != Kind::opamp && at.kind != Kind::pin) return 0;
    const LinkedSource source = behind_wires(board_, {amp.chip, at});
    if (source.sampled_phase == 0 && contains(members_, source.node)) return member(source.node, true);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (sources[i].node == source.node && sources[i].sampled_phase == source.sampled_phase)
        return network.inputs[i];
    }
    sources.push_back(source);
    network.inputs.push_back(network.add_node());
    return network.inputs.back();
  }

  int member(const BoardNode& amp, bool output) const {
    const auto at = std::find(members_.begin(), members_.end(), amp);
    if (at == members_.end()) return 0;
    const auto& opamp = network.opamps[static_cast<std::size_t>(at - members_.begin())];
    return output ? opamp.out : opamp.minus;
  }

  const BoardCircuit& board_;
  std::vector<BoardNode> members_;
  std::vector<const CapacitorCell*> placed_;
  bool missing_clock_ = false;
};

/// A follower behind a switch that is closed in one phase.
SwitchedNetwork sampler(int phase) {
  SwitchedNetwork out;
  const int in = out.add_node();
  const int held = out.add_node();
  const int output = out.add_node();
  out.inputs = {in};
  out.switches = {{in, held, 0, phase}};
  out.capacitors = {{"Chold", held, 0, 1.0}};
  out.opamps = {{.plus = held, .minus = output, .out = output}};
  return out;
}

class PinNetworks {
 public:
  PinNetworks(const BoardCircuit& board, const BoardNode& input)
      : board_(board), input_(input), out_(2.0 * board.master.value) {}

  Outcome<PeriodicNetworks> between(const BoardNode& output, int sampled_phase) {
    LinkedSource end = behind_wires(board_, output);
    if (sampled_phase != 0) end.sampled_phase = sampled_phase;
    const Outcome<Source> source = add(end);
    if (const Refusal* refusal = refusal_of(source)) return *refusal;
    const Source& made = std::get<Source>(source);
    if (made.kind == Source::Kind::nothing) return Refusal{"the output does not depend on the input"};
    if (made.kind == Source::Kind::network) out_.set_output(made.network);
    return std::move(out_);
  }

 private:
  Outcome<Source> add(const LinkedSource& from) {
    Source source;
    if (from.node.node.kind == Kind::pin) {
      if (from.node == input_) source.kind = Source::Kind::board_input;
      return source;
    }
    if (from.node.node.kind != Kind::opamp) return source;
    const auto known = known_.find(key(from.node));
    if (known != known_.end()) {
      source = {Source::Kind::network, known->second};
    } else {
      const Outcome<Source> made = add_opamp(from.node);
      if (refusal_of(made) != nullptr) return made;
      source = std::get<Source>(made);
    }
    if (from.sampled_phase == 0) return source;
    const std::int64_t period =
        std::int64_t{2} *
        std::max(
            1, opamp_clock(board_.chips[from.node.chip], from.node.node.cab, from.node.node.number).divisor);
    return Source{Source::Kind::network,
                  out_.add(ClockedNetwork(sampler(from.sampled_phase), {period}), {source})};
  }

  Outcome<Source> add_opamp(const BoardNode& amp) {
    LoopNetwork loop(board_, loop_of(board_, amp));
    if (const auto refusal = loop.build()) return *refusal;
    std::vector<Source> sources;
    for (const LinkedSource& one : loop.sources) {
      const Outcome<Source> source = add(one);
      if (refusal_of(source) != nullptr) return source;
      sources.push_back(std::get<Source>(source));
    }
    const std::size_t index = out_.add(ClockedNetwork(loop.network, loop.periods), std::move(sources));
    known_.emplace(key(amp), index);
    return Source{Source::Kind::network, index};
  }

  static std::array<std::size_t, 3> key(const BoardNode& amp) {
    return {amp.chip, static_cast<std::size_t>(amp.node.cab), static_cast<std::size_t>(amp.node.number)};
  }

  const BoardCircuit& board_;
  BoardNode input_;
  PeriodicNetworks out_;
  std::map<std::array<std::size_t, 3>, std::size_t> known_;
};

}  // namespace

Outcome<PeriodicNetworks> pin_networks(const BoardCircuit& board, BoardPin from, BoardPin to) {
  const auto index_of = [&](int address) {
    return static_cast<std::size_t>(
        std::find_if(board.chips.begin(), board.chips.end(),
                     [&](const ChipCircuit& c) { return c.address1 == address; }) -
        board.chips.begin());
  };
  const std::size_t first = index_of(from.chip);
  const std::size_t last = index_of(to.chip);
  if (first == board.chips.size() || last == board.chips.size())
    return Refusal{"there is no stream for one of the chips"};
  const IoCell& cell = board.chips[last].cell(to.cell);
  if (!cell.is_output()) return Refusal{fmt::format("chip{}.IO{} is no output", to.chip, to.cell)};
  return PinNetworks(board, {first, {Kind::pin, 0, from.cell}})
      .between({last, cell.source}, cell.sample_phase);
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
