#include "fpaa/streams/charge_system.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "numeric/dense.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

using Kind = CircuitNode::Kind;
using Clock = SwitchWord::Clock;

const OpAmpCell& opamp_cell(const ChipCircuit& chip, int cab, int number) {
  return chip.cab(cab).opamps[static_cast<std::size_t>(number - 1)];
}

bool is_joined(const CapacitorCell& c, int phase) {
  const auto p = static_cast<std::size_t>(phase - 1);
  return c.near.at[p].kind != Kind::open && c.far.at[p].kind != Kind::open;
}

bool feeds(const CapacitorCell& c, int cab, int opamp) {
  const CircuitNode ground{Kind::virtual_ground, cab, opamp};
  return c.far.at[0] == ground || c.far.at[1] == ground;
}

constexpr int kMostLinks = 64;  ///< passed from pin to pin before a ring of wires is suspected

}  // namespace

OpAmpClock opamp_clock(const ChipCircuit& chip, int cab, int opamp) {
  OpAmpClock out;
  const CabCell& cell = chip.cab(cab);
  const auto use = [&](Clock by) {
    if (by == Clock::none) return;
    const std::optional<int> clock = cell.clock(by);
    if (!clock) {
      out.obstacle = fmt::format("op-amp {} of CAB {} has switches that no chip clock moves", opamp, cab);
      return;
    }
    const int divisor = chip.system1_divisor * chip.divisors[static_cast<std::size_t>(*clock)];
    if (out.divisor != 0 && out.divisor != divisor) {
      out.obstacle = fmt::format("op-amp {} of CAB {} is switched by two clocks", opamp, cab);
    }
    out.divisor = divisor;
  };
  for (const CapacitorCell& c : cell.capacitors) {
    if (!feeds(c, cab, opamp)) continue;
    if (!c.is_understood) {
      out.obstacle = fmt::format("C{} of CAB {} has switches that are not understood", c.number, cab);
    } else {
      use(c.near.clock);
      use(c.far.clock);
    }
  }
  use(opamp_cell(chip, cab, opamp).reset_clock);
  return out;
}

int valid_phase(const ChipCircuit& chip, int cab, int opamp) {
  return opamp_cell(chip, cab, opamp).reset_phase == 1 ? 2 : 1;
}

std::optional<LinkedSource> behind_link(const BoardCircuit& board, std::size_t chip, int cell) {
  LinkedSource out{{chip, {Kind::pin, 0, cell}}, 0};
  bool moved = false;
  for (int i = 0; i < kMostLinks && out.node.node.kind == Kind::pin; ++i) {
    const auto link = std::find_if(board.links.begin(), board.links.end(), [&](const PinLink& l) {
      return static_cast<std::size_t>(l.to_chip) == out.node.chip && l.to_cell == out.node.node.number;
    });
    if (link == board.links.end()) break;
    const auto from = static_cast<std::size_t>(link->from_chip);
    const IoCell& source = board.chips[from].cell(link->from_cell);
    // From an output cell what drives it; from an input cell the wire that feeds it.
    out.node = {from, source.is_output() ? source.source : CircuitNode{Kind::pin, 0, link->from_cell}};
    if (source.is_output() && source.sample_phase != 0) out.sampled_phase = source.sample_phase;
    moved = true;
  }
  if (!moved) return std::nullopt;
  return out;
}

ChargeSystem::ChargeSystem(const BoardCircuit& board, std::vector<BoardNode> opamps)
    : board_(board), opamps_(std::move(opamps)) {
  int fastest = 0;
  for (const BoardNode& amp : opamps_) {
    const OpAmpClock clock = opamp_clock(board.chips[amp.chip], amp.node.cab, amp.node.number);
    if (!clock.obstacle.empty()) obstacle_ = clock.obstacle;
    divisors_.push_back(clock.divisor);
    if (clock.divisor != 0 && (fastest == 0 || clock.divisor < fastest)) fastest = clock.divisor;
  }
  // An op-amp without any switch follows at once: any clock will do.
  for (int& divisor : divisors_) {
    if (divisor == 0) divisor = std::max(fastest, 1);
  }
  for (std::size_t i = 0; i < opamps_.size(); ++i) {
    balance(i, board.chips[opamps_[i].chip].cab(opamps_[i].node.cab));
  }
}

void ChargeSystem::balance(std::size_t i, const CabCell& cab) {
  const BoardNode& amp = opamps_[i];
  const CircuitNode ground{Kind::virtual_ground, amp.node.cab, amp.node.number};
  const int divisor = divisors_[i];
  for (const int phase : {1, 2}) {
    const std::size_t row = 2 * i + static_cast<std::size_t>(phase - 1);
    const OpAmpCell& cell = cab.opamps[static_cast<std::size_t>(amp.node.number - 1)];
    if (!cell.on || cell.reset_phase == phase) {
      entries_.push_back({row, row, false, 0, 1.0, 0, divisor});
      continue;
    }
    for (const CapacitorCell& c : cab.capacitors) {
      if (!(c.far.at[static_cast<std::size_t>(phase - 1)] == ground) || !is_joined(c, phase)) continue;
      charge(row, amp, c, phase, 1.0, 0, divisor);
      // What it held before: from the other phase, or from this one a period ago.
      const int other = 3 - phase;
      if (is_joined(c, other)) {
        charge(row, amp, c, other, -1.0, phase == 1 ? 2 : 0, divisor);
      } else {
        charge(row, amp, c, phase, -1.0, 2, divisor);
      }
    }
  }
}

void ChargeSystem::charge(std::size_t row, const BoardNode& who, const CapacitorCell& c, int phase,
                          double sign, int half_cycles, int divisor) {
  const CircuitNode& near = c.near.at[static_cast<std::size_t>(phase - 1)];
  if (near.kind != Kind::opamp && near.kind != Kind::pin) return;
  add(row, {who.chip, near}, phase, sign * c.units, half_cycles, divisor);
}

void ChargeSystem::add(std::size_t row, BoardNode node, int phase, double value, int half_cycles,
                       int divisor) {
  if (node.node.kind == Kind::pin) {
    if (const auto linked = behind_link(board_, node.chip, node.node.number)) {
      node = linked->node;
      if (linked->sampled_phase != 0) {
        // Sampled at the end of phase 2, it is what phase 1 of the next period still sees.
        if (linked->sampled_phase == 2 && phase == 1) half_cycles += 2;
        phase = linked->sampled_phase;
      }
    }
  }
  if (node.node.kind != Kind::opamp && node.node.kind != Kind::pin) return;
  const auto unknown = std::find(opamps_.begin(), opamps_.end(), node);
  if (unknown != opamps_.end()) {
    const auto j = static_cast<std::size_t>(unknown - opamps_.begin());
    // From another clock: its held output.
    if (divisors_[j] != divisor)
      phase = valid_phase(board_.chips[node.chip], node.node.cab, node.node.number);
    entries_.push_back(
        {row, 2 * j + static_cast<std::size_t>(phase - 1), false, phase, value, half_cycles, divisor});
    return;
  }
  auto source = std::find(sources_.begin(), sources_.end(), node);
  if (source == sources_.end()) source = sources_.insert(sources_.end(), node);
  entries_.push_back(
      {row, static_cast<std::size_t>(source - sources_.begin()), true, phase, value, half_cycles, divisor});
}

namespace {
Complex delayed(double value, int half_cycles, int divisor, const ChargeSystem::HalfDelay& delay) {
  if (half_cycles == 0) return value;
  const Complex half = delay(divisor);
  return value * (half_cycles == 2 ? half * half : half_cycles == 4 ? half * half * half * half : half);
}
}  // namespace

Eigen::MatrixXcd ChargeSystem::matrix(const HalfDelay& delay) const {
  const auto n = static_cast<Eigen::Index>(2 * opamps_.size());
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(n, n);
  for (const Entry& e : entries_) {
    if (e.is_source) continue;
    out(static_cast<Eigen::Index>(e.row), static_cast<Eigen::Index>(e.column)) +=
        delayed(e.value, e.half_cycles, e.divisor, delay);
  }
  return out;
}

Eigen::VectorXcd ChargeSystem::right_hand_side(const std::vector<Phases>& sources,
                                               const HalfDelay& delay) const {
  Eigen::VectorXcd out = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(2 * opamps_.size()));
  for (const Entry& e : entries_) {
    if (!e.is_source) continue;
    const Complex voltage = e.phase == 1 ? sources[e.column].first : sources[e.column].second;
    if (voltage == 0.0) continue;
    out(static_cast<Eigen::Index>(e.row)) -= delayed(e.value, e.half_cycles, e.divisor, delay) * voltage;
  }
  return out;
}

std::optional<std::vector<ChargeSystem::Phases>> ChargeSystem::solve(const std::vector<Phases>& sources,
                                                                     const HalfDelay& delay) const {
  const auto x = solve_regular(matrix(delay), right_hand_side(sources, delay));
  if (!x) return std::nullopt;
  std::vector<Phases> out;
  for (Eigen::Index i = 0; i < x->size(); i += 2) out.push_back({(*x)(i), (*x)(i + 1)});
  return out;
}

Complex ChargeSystem::determinant(Complex z_inverse) const {
  const Complex half = std::sqrt(z_inverse);
  return bodesmith::determinant(matrix([&](int) { return half; }));
}

Complex ChargeSystem::numerator(Complex z_inverse, std::size_t opamp, int phase,
                                const std::vector<Phases>& sources) const {
  const Complex half = std::sqrt(z_inverse);
  const HalfDelay delay = [&](int) { return half; };
  Eigen::MatrixXcd a = matrix(delay);
  a.col(static_cast<Eigen::Index>(2 * opamp) + phase - 1) = right_hand_side(sources, delay);
  return bodesmith::determinant(a);
}

}  // namespace bodesmith::fpaa::an231
