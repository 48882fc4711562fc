#include "fpaa/streams/board_networks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <numeric>

#include "base/text.hpp"
#include "numeric/fourier.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::fpaa::an231 {
namespace {
using Kind = CircuitNode::Kind;
using Source = PeriodicNetworks::Source;

constexpr int kMostLinks = 64;  ///< passed from pin to pin before a ring of wires is suspected

const OpAmpCell& opamp_cell(const BoardCircuit& board, const BoardNode& amp) {
  return board.chips[amp.chip].cab(amp.node.cab).opamps[static_cast<std::size_t>(amp.node.number - 1)];
}

/// Half periods of the master clock in a period of a chip clock.
std::int64_t ticks_of(const ChipCircuit& chip, int clock) {
  return std::int64_t{2} * chip.system1_divisor * chip.divisors.at(static_cast<std::size_t>(clock));
}

/// What drives a node behind the wires outside the chips, with the phase and clock by which a sampling output cell
/// took it (0: it is not sampled).
struct LinkedSource {
  BoardNode node;
  int sampled_phase = 0;
  std::int64_t sampled_period = 2;
  friend bool operator==(const LinkedSource&, const LinkedSource&) = default;

  void sample(const ChipCircuit& chip, const IoCell& cell) {
    if (cell.sample_phase == 0) return;
    sampled_phase = cell.sample_phase;
    sampled_period = ticks_of(chip, cell.sample_clock);
  }
};

LinkedSource behind_wires(const BoardCircuit& board, const BoardNode& node) {
  LinkedSource out{node};
  for (int i = 0; i < kMostLinks && out.node.node.kind == Kind::pin; ++i) {
    const BoardPin pin{board.chips[out.node.chip].address1, out.node.node.number};
    const auto link = std::ranges::find(board.links, pin, &PinLink::to);
    if (link == board.links.end()) break;
    const std::size_t from = board.index_of(link->from.chip).value();
    const IoCell& source = board.chips[from].cell(link->from.cell);
    // From an output cell what drives it; from an input cell the wire that feeds it.
    out.node = {from, source.is_output() ? source.source : CircuitNode{Kind::pin, 0, link->from.cell}};
    if (source.is_output()) out.sample(board.chips[from], source);
  }
  return out;
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
  return std::ranges::find(list, node) != list.end();
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

/// One loop of op-amps as a stage.
class StageReader {
 public:
  StageReader(const BoardCircuit& board, std::vector<BoardNode> members)
      : board_(board), members_(std::move(members)) {}

  void read() {
    stage.opamps.clear();
    std::vector<const CapacitorCell*> placed;
    for (const BoardNode& amp : members_) {
      for (const CapacitorCell* c : capacitors_at(board_, amp)) {
        // Of two op-amps' capacitor the first has it.
        if (std::ranges::find(placed, c) != placed.end()) continue;
        placed.push_back(c);
        if (!c->is_understood)
          throw DesignError(
              fmt::format("C{} of CAB {} has switches that are not understood", c->number, amp.node.cab));
        const Plate near = plate(amp, c->near);
        stage.capacitors.push_back(
            {fmt::format("C{}", c->number), static_cast<double>(c->units), near, plate(amp, c->far)});
      }
      const OpAmpCell& cell = opamp_cell(board_, amp);
      if (!cell.on)
        throw DesignError(fmt::format("op-amp {} of CAB {} is off", amp.node.number, amp.node.cab));
      stage.opamps.push_back({cell.reset_phase, cell.reset_phase != 0 ? clock(amp, cell.reset_clock) : 0});
    }
    if (missing_clock_) throw DesignError("a switch is moved by a clock that the chip does not have");
  }

  bool switches() const { return !periods_.empty(); }
  /// Of its clocks; nothing switches: any clock will do.
  std::vector<std::int64_t> periods() const { return switches() ? periods_ : std::vector<std::int64_t>{2}; }
  ClockedNetwork network() const { return ClockedNetwork(circuit_of(stage), periods()); }

  StageSwitches stage;
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
    const std::int64_t period = ticks_of(chip, *number);
    const auto at = std::ranges::find(periods_, period);
    if (at != periods_.end()) return static_cast<int>(at - periods_.begin());
    periods_.push_back(period);
    return static_cast<int>(periods_.size()) - 1;
  }

  Plate plate(const BoardNode& amp, const SwitchWord& word) {
    Plate out{node(amp, word.at[0]), node(amp, word.at[1])};
    if (word.clock != SwitchWord::Clock::none && (out.phase1 != PlateNode{} || out.phase2 != PlateNode{}))
      out.clock = clock(amp, word.clock);
    return out;
  }

  PlateNode node(const BoardNode& amp, const CircuitNode& at) {
    if (at.kind == Kind::open) return {};
    if (at.kind == Kind::virtual_ground)
      return member({amp.chip, {Kind::opamp, at.cab, at.number}}, PlateNode::Kind::virtual_ground);
    if (at.kind != Kind::opamp && at.kind != Kind::pin) return PlateNode::ground();
    const LinkedSource source = behind_wires(board_, {amp.chip, at});
    if (source.sampled_phase == 0 && contains(members_, source.node))
      return member(source.node, PlateNode::Kind::opamp);
    auto known = std::ranges::find(sources, source);
    if (known == sources.end()) known = sources.insert(known, source);
    return PlateNode::input(static_cast<int>(known - sources.begin()) + 1);
  }

  PlateNode member(const BoardNode& amp, PlateNode::Kind kind) const {
    const auto at = std::ranges::find(members_, amp);
    return at == members_.end() ? PlateNode::ground()
                                : PlateNode{kind, static_cast<int>(at - members_.begin()) + 1};
  }

  const BoardCircuit& board_;
  std::vector<BoardNode> members_;
  std::vector<std::int64_t> periods_;
  bool missing_clock_ = false;
};

/// A follower behind a switch that is closed in one phase.
SwitchedCircuit sampler(int phase) {
  SwitchedCircuit out{{}, {"in"}, "out", {{"p", 0, phase}}};
  out.netlist.opamp = schematic::OpAmpModel::ideal();
  out.netlist.opamps = {{"A", "", 0, "held", "out", "out"}};
  out.netlist.contacts = {{"S", 0, "in", "held", "p"}};
  out.netlist.parts = {{schematic::Part::Kind::capacitor, "Chold", "", 0, "held", "0", "", 1.0, 1.0}};
  return out;
}

class PinNetworks {
 public:
  PinNetworks(const BoardCircuit& board, const BoardNode& input)
      : board_(board), input_(input), out_(2.0 * board.master.value) {}

  PeriodicNetworks to(std::size_t chip, const IoCell& cell) {
    LinkedSource end = behind_wires(board_, {chip, cell.source});
    end.sample(board_.chips[chip], cell);
    const Source made = add(end);
    if (made.kind == Source::Kind::nothing) throw DesignError("the output does not depend on the input");
    if (made.kind == Source::Kind::network) out_.set_output(made.network);
    return std::move(out_);
  }

 private:
  Source add(const LinkedSource& from) {
    Source source;
    if (from.node.node.kind == Kind::pin) {
      if (from.node == input_) source.kind = Source::Kind::board_input;
      return source;
    }
    if (from.node.node.kind != Kind::opamp) return source;
    source = {Source::Kind::network, opamp(from.node)};
    if (from.sampled_phase == 0) return source;
    return Source{Source::Kind::network,
                  out_.add(ClockedNetwork(sampler(from.sampled_phase), {from.sampled_period}), {source})};
  }

  std::size_t opamp(const BoardNode& amp) {
    const std::array<std::size_t, 3> key{amp.chip, static_cast<std::size_t>(amp.node.cab),
                                         static_cast<std::size_t>(amp.node.number)};
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    StageReader loop(board_, loop_of(board_, amp));
    loop.read();
    std::vector<Source> sources;
    for (const LinkedSource& one : loop.sources) sources.push_back(add(one));
    return known_[key] = out_.add(loop.network(), std::move(sources));
  }

  const BoardCircuit& board_;
  BoardNode input_;
  PeriodicNetworks out_;
  std::map<std::array<std::size_t, 3>, std::size_t> known_;
};

constexpr double kLargestWhole = 1e14;
constexpr double kTransferRounding = 1e-6;

/// Coefficients from values at the N-th roots of unity.
std::vector<double> coefficients(const std::vector<Complex>& values) {
  std::vector<double> out;
  for (const Complex c : fourier(values)) out.push_back(c.real() / static_cast<double>(values.size()));
  return out;
}

/// Whole numbers without a common divisor where they are exact, otherwise a denominator that starts with 1;
/// no trailing zeros.
void tidy(StageTransfer& stage) {
  std::vector<std::vector<double>*> all{&stage.denominator};
  for (auto& numerator : stage.numerators) all.push_back(&numerator);
  double largest = 0.0;
  for (const auto* p : all) {
    for (const double c : *p) largest = std::max(largest, std::abs(c));
  }
  std::int64_t common = 0;
  if (largest < kLargestWhole) {
    for (auto* p : all) {
      for (double& c : *p) {
        if (std::abs(c - std::round(c)) > std::max(kTransferRounding, 1e-13 * largest)) common = -1;
        c = common < 0 ? c : std::round(c);
        if (common >= 0) common = std::gcd(common, static_cast<std::int64_t>(c));
      }
    }
  }
  const double scale = common > 0 ? static_cast<double>(common) : stage.denominator[0];
  const double sign = stage.denominator[0] < 0.0 && common > 0 ? -1.0 : 1.0;
  for (auto* p : all) {
    for (double& c : *p) {
      c = std::abs(c) <= 1e-13 * largest && common <= 0 ? 0.0 : sign * c / scale + 0.0;
    }
    while (p->size() > 1 && p->back() == 0.0) p->pop_back();
  }
}

/// A gain made of equal static and switched ratios: numerators and denominator are one polynomial, cancelled.
void cancel_gain(StageTransfer& stage) {
  if (stage.numerators.empty()) return;
  const std::vector<double>& d = stage.denominator;
  for (const std::vector<double>& n : stage.numerators) {
    for (std::size_t i = 0; i < std::max(n.size(), d.size()); ++i) {
      const double above = i < n.size() ? n[i] : 0.0;
      const double below = i < d.size() ? d[i] : 0.0;
      if (std::abs(above * d[0] - n[0] * below) > 1e-12 * std::abs(n[0] * d[0])) return;
    }
  }
  for (std::vector<double>& n : stage.numerators) n.resize(1);
  stage.denominator.resize(1);
}

/// Voltages of a source at the end of phase 1 and of phase 2, at a value of 1/z: 0 while its op-amp is reset; what a
/// cell samples at the end of phase 2 is what phase 1 of the next period still sees.
std::array<Complex, 2> held_phases(const BoardCircuit& board, const LinkedSource& source, Complex z_inverse) {
  std::array<Complex, 2> out{1.0, 1.0};
  if (source.node.node.kind == Kind::opamp) {
    const int reset = opamp_cell(board, source.node).reset_phase;
    if (reset != 0) out[static_cast<std::size_t>(reset - 1)] = 0.0;
  }
  if (source.sampled_phase == 1) out[1] = out[0];
  if (source.sampled_phase == 2) out[0] = out[1] * z_inverse;
  return out;
}

/// det of the capacitances from the members' outputs to their virtual grounds in both phases: what makes the
/// polynomials whole numbers.
double feedback_determinant(const BoardCircuit& board, const std::vector<BoardNode>& members) {
  double out = 1.0;
  const auto n = static_cast<Eigen::Index>(members.size());
  for (std::size_t phase = 0; phase < 2; ++phase) {
    Eigen::MatrixXcd f = Eigen::MatrixXcd::Zero(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const BoardNode& amp = members[static_cast<std::size_t>(k)];
      const CircuitNode ground{Kind::virtual_ground, amp.node.cab, amp.node.number};
      if (opamp_cell(board, amp).reset_phase == static_cast<int>(phase) + 1) {
        f(k, k) = 1.0;
        continue;
      }
      for (const CapacitorCell* c : capacitors_at(board, amp)) {
        if (!(c->far.at[phase] == ground)) continue;
        const BoardNode from = behind_wires(board, {amp.chip, c->near.at[phase]}).node;
        const auto at = std::ranges::find(members, from);
        if (at != members.end()) f(k, at - members.begin()) += c->units;
      }
    }
    out *= bodesmith::determinant(f).real();
  }
  return out;
}

/// Values of denominator and numerators at the roots of unity, from the two maps of a period (clocked_network.hpp),
///   q+ = A q + b u,  y = c q + d u:  det(I - A/z)  and  det(I - A/z, -b/z; c, d).
void find_polynomials(const BoardCircuit& board, const std::vector<LinkedSource>& sources,
                      const ClockedNetwork& clocked, double scale, StageTransfer& out) {
  const ClockedNetwork::Interval& one = clocked.intervals().at(0);
  const ClockedNetwork::Interval& two = clocked.intervals().at(1);
  const Eigen::Index n = one.m.cols();
  const Eigen::MatrixXd a = two.m * one.m;
  const Eigen::Index row = static_cast<Eigen::Index>(clocked.output());
  const Eigen::RowVectorXd c =
      out.phase == 1 ? Eigen::RowVectorXd(one.c.row(row)) : Eigen::RowVectorXd(two.c.row(row) * one.m);
  const auto points = static_cast<std::size_t>(n + 3);
  std::vector<Complex> below;
  std::vector<std::vector<Complex>> above(sources.size());
  for (std::size_t i = 0; i < points; ++i) {
    const Complex x =
        std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(points));
    Eigen::MatrixXcd whole = Eigen::MatrixXcd::Zero(n + 1, n + 1);
    whole.topLeftCorner(n, n) = Eigen::MatrixXcd::Identity(n, n) - x * a;
    whole.bottomLeftCorner(1, n) = c.cast<Complex>();
    below.push_back(scale * bodesmith::determinant(Eigen::MatrixXcd(whole.topLeftCorner(n, n))));
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const auto input = static_cast<Eigen::Index>(s);
      const auto u = held_phases(board, sources[s], x);
      const Eigen::VectorXcd middle = one.n.col(input) * u[0];
      whole.topRightCorner(n, 1) = -x * (two.m * middle + two.n.col(input) * u[1]);
      whole(n, n) = out.phase == 1 ? one.d(row, input) * u[0]
                                   : (two.c.row(row) * middle).value() + two.d(row, input) * u[1];
      above[s].push_back(scale * bodesmith::determinant(whole));
    }
  }
  out.denominator = coefficients(below);
  for (const auto& values : above) out.numerators.push_back(coefficients(values));
}

StageTransfer stage_of(const BoardCircuit& board, const BoardNode& amp) {
  StageTransfer out;
  out.opamp = amp;
  out.half_period = opamp_cell(board, amp).reset_phase != 0;
  out.phase = opamp_cell(board, amp).reset_phase == 1 ? 2 : 1;
  const std::vector<BoardNode> members = loop_of(board, amp);
  StageReader loop(board, members);
  try {
    loop.read();
    if (loop.switches()) out.clock_divisor = static_cast<int>(loop.periods().front() / 2);
    if (loop.periods().size() > 1)
      throw DesignError(
          fmt::format("op-amp {} of CAB {} is switched by two clocks", amp.node.number, amp.node.cab));
    const double scale = feedback_determinant(board, members);
    if (scale == 0.0)
      throw DesignError(fmt::format("op-amp {} of CAB {} has no feedback", amp.node.number, amp.node.cab));
    find_polynomials(board, loop.sources, loop.network(), scale, out);
  } catch (const DesignError& error) {
    out.obstacle = error.what();
  }
  for (const LinkedSource& source : loop.sources) out.inputs.push_back(source.node);
  double largest = 0.0;
  for (const double c : out.denominator) largest = std::max(largest, std::abs(c));
  if (out.obstacle.empty() && (!std::isfinite(largest) || std::abs(out.denominator[0]) <= 1e-12 * largest)) {
    out.obstacle = "the switches leave a voltage open";
    out.numerators.clear();
    out.denominator.clear();
  }
  if (!out.obstacle.empty()) return out;
  tidy(out);
  cancel_gain(out);
  tidy(out);
  return out;
}

}  // namespace

std::optional<std::size_t> BoardCircuit::index_of(int address1) const {
  const auto at = std::ranges::find(chips, address1, &ChipCircuit::address1);
  return at == chips.end() ? std::nullopt : std::optional(static_cast<std::size_t>(at - chips.begin()));
}

PeriodicNetworks pin_networks(const BoardCircuit& board, BoardPin from, BoardPin to) {
  const auto first = board.index_of(from.chip);
  const auto last = board.index_of(to.chip);
  if (!first || !last) throw DesignError("there is no stream for one of the chips");
  const IoCell& cell = board.chips[*last].cell(to.cell);
  if (!cell.is_output()) throw DesignError(fmt::format("chip{}.IO{} is no output", to.chip, to.cell));
  return PinNetworks(board, {*first, {Kind::pin, 0, from.cell}}).to(*last, cell);
}

Outcome<SignalPins> signal_pins(const BoardCircuit& board) {
  std::vector<BoardPin> inputs;
  std::vector<BoardPin> outputs;
  std::vector<std::string> names;
  for (const ChipCircuit& chip : board.chips) {
    for (const IoCell& cell : chip.cells) {
      const BoardPin pin{chip.address1, cell.number};
      const bool wired = std::ranges::any_of(
          board.links, [&](const PinLink& l) { return l.to == pin || (l.from == pin && cell.is_output()); });
      if (wired || (!cell.is_input() && !cell.is_output())) continue;
      (cell.is_input() ? inputs : outputs).push_back(pin);
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

std::vector<StageTransfer> stage_transfers(const BoardCircuit& board) {
  std::vector<StageTransfer> out;
  for (std::size_t chip = 0; chip < board.chips.size(); ++chip) {
    for (const CabCell& cab : board.chips[chip].cabs) {
      for (int o = 1; o <= kOpAmps; ++o) {
        const BoardNode amp{chip, {Kind::opamp, cab.cab, o}};
        const auto acting = capacitors_at(board, amp);
        const bool reads = std::ranges::any_of(acting, [](const CapacitorCell* c) {
          return std::ranges::any_of(c->near.at, [](const CircuitNode& near) {
            return near.kind == Kind::opamp || near.kind == Kind::pin;
          });
        });
        if (opamp_cell(board, amp).on && reads) out.push_back(stage_of(board, amp));
      }
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa::an231
