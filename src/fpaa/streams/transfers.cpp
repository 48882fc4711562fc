#include "fpaa/streams/transfers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

namespace bodesmith::fpaa::an231 {
namespace {

using Kind = CircuitNode::Kind;

/// Follows wires between chips; a pin that is wired to nothing stays itself.
BoardNode origin(const BoardCircuit& board, BoardNode node) {
  if (node.node.kind != Kind::pin) return node;
  const auto linked = behind_link(board, node.chip, node.node.number);
  return linked ? linked->node : node;
}

/// Op-amps and pins that an op-amp's capacitors read.
std::vector<BoardNode> read_by(const BoardCircuit& board, const BoardNode& amp) {
  std::vector<BoardNode> out;
  const CircuitNode ground{Kind::virtual_ground, amp.node.cab, amp.node.number};
  for (const CapacitorCell& c : board.chips[amp.chip].cab(amp.node.cab).capacitors) {
    if (!(c.far.at[0] == ground) && !(c.far.at[1] == ground)) continue;
    for (const CircuitNode& near : c.near.at) {
      if (near.kind != Kind::opamp && near.kind != Kind::pin) continue;
      const BoardNode node = origin(board, {amp.chip, near});
      if (std::find(out.begin(), out.end(), node) == out.end()) out.push_back(node);
    }
  }
  return out;
}

/// The op-amp and all op-amps that it depends on.
std::vector<BoardNode> cone(const BoardCircuit& board, const BoardNode& amp) {
  std::vector<BoardNode> out{amp};
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (const BoardNode& node : read_by(board, out[i])) {
      if (node.node.kind == Kind::opamp && std::find(out.begin(), out.end(), node) == out.end()) {
        out.push_back(node);
      }
    }
  }
  return out;
}

/// Op-amps in a ring with this one (itself at least).
std::vector<BoardNode> ring(const BoardCircuit& board, const BoardNode& amp) {
  std::vector<BoardNode> out;
  for (const BoardNode& node : cone(board, amp)) {
    const std::vector<BoardNode> back = cone(board, node);
    if (std::find(back.begin(), back.end(), amp) != back.end()) out.push_back(node);
  }
  return out;
}

constexpr double kLargestWhole = 1e14;
constexpr double kTransferRounding = 1e-6;

/// Coefficients from values at the N-th roots of unity.
std::vector<double> coefficients(const std::vector<Complex>& values) {
  const std::size_t n = values.size();
  std::vector<double> out(n);
  for (std::size_t k = 0; k < n; ++k) {
    Complex sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double angle =
          -2.0 * std::numbers::pi * static_cast<double>((i * k) % n) / static_cast<double>(n);
      sum += values[i] * std::polar(1.0, angle);
    }
    out[k] = sum.real() / static_cast<double>(n);
  }
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

StageTransfer stage_of(const BoardCircuit& board, const BoardNode& amp) {
  StageTransfer out;
  out.opamp = amp;
  const ChipCircuit& chip = board.chips[amp.chip];
  out.phase = valid_phase(chip, amp.node.cab, amp.node.number);
  const OpAmpCell& cell = chip.cab(amp.node.cab).opamps[static_cast<std::size_t>(amp.node.number - 1)];
  out.half_period = cell.reset_phase != 0;
  const std::vector<BoardNode> members = ring(board, amp);
  for (const BoardNode& member : members) {
    const int divisor = opamp_clock(board.chips[member.chip], member.node.cab, member.node.number).divisor;
    if (divisor == 0) continue;
    if (out.clock_divisor != 0 && divisor != out.clock_divisor) out.obstacle = "a loop with two clocks";
    out.clock_divisor = divisor;
  }
  const ChargeSystem system(board, members);
  if (!system.obstacle().empty()) out.obstacle = system.obstacle();
  out.inputs = system.sources();
  if (!out.obstacle.empty()) return out;

  const auto self =
      static_cast<std::size_t>(std::find(members.begin(), members.end(), amp) - members.begin());
  const std::size_t points = 2 * members.size() + 2;
  std::vector<Complex> below;
  std::vector<std::vector<Complex>> above(out.inputs.size());
  for (std::size_t i = 0; i < points; ++i) {
    const Complex x =
        std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(points));
    below.push_back(system.determinant(x));
    for (std::size_t s = 0; s < out.inputs.size(); ++s) {
      std::vector<ChargeSystem::Phases> voltages(out.inputs.size());
      voltages[s] = {1.0, 1.0};
      const BoardNode& source = out.inputs[s];
      if (source.node.kind == Kind::opamp) {
        const CabCell& cab = board.chips[source.chip].cab(source.node.cab);
        const int reset = cab.opamps[static_cast<std::size_t>(source.node.number - 1)].reset_phase;
        if (reset == 1) voltages[s].first = 0.0;
        if (reset == 2) voltages[s].second = 0.0;
      }
      above[s].push_back(system.numerator(x, self, out.phase, voltages));
    }
  }
  out.denominator = coefficients(below);
  for (const auto& values : above) out.numerators.push_back(coefficients(values));
  double size = 0.0;
  for (const double c : out.denominator) size = std::max(size, std::abs(c));
  if (!(size > 0.0) || !std::isfinite(size) || std::abs(out.denominator[0]) <= 1e-12 * size) {
    out.obstacle = fmt::format("op-amp {} of CAB {} has no feedback", amp.node.number, amp.node.cab);
    out.numerators.clear();
    out.denominator.clear();
    return out;
  }
  tidy(out);
  cancel_gain(out);
  tidy(out);
  return out;
}

}  // namespace

std::vector<StageTransfer> stage_transfers(const BoardCircuit& board) {
  std::vector<StageTransfer> out;
  for (std::size_t chip = 0; chip < board.chips.size(); ++chip) {
    for (const CabCell& cab : board.chips[chip].cabs) {
      for (int o = 1; o <= kOpAmps; ++o) {
        const bool on = cab.opamps[static_cast<std::size_t>(o - 1)].on;
        const BoardNode amp{chip, {Kind::opamp, cab.cab, o}};
        if (on && !read_by(board, amp).empty()) out.push_back(stage_of(board, amp));
      }
    }
  }
  return out;
}

PinResponse::PinResponse(const BoardCircuit& board, std::size_t from_chip, int from_cell, std::size_t to_chip,
                         int to_cell)
    : master_(board.master) {
  const IoCell& cell = board.chips.at(to_chip).cell(to_cell);
  const BoardNode input{from_chip, {Kind::pin, 0, from_cell}};
  if (!cell.is_output()) {
    obstacle_ = fmt::format("IO{} is no output", to_cell);
    return;
  }
  const BoardNode end = origin(board, {to_chip, cell.source});
  if (end.node.kind == Kind::pin) {
    wire_ = true;
    if (end == input) source_ = 0;
    return;
  }
  if (end.node.kind != Kind::opamp) {
    obstacle_ = fmt::format("nothing drives IO{}", to_cell);
    return;
  }
  system_.emplace(board, cone(board, end));
  obstacle_ = system_->obstacle();
  output_phase_ = cell.sample_phase != 0 && end.chip == to_chip
                      ? cell.sample_phase
                      : valid_phase(board.chips[end.chip], end.node.cab, end.node.number);
  output_divisor_ = std::max(opamp_clock(board.chips[end.chip], end.node.cab, end.node.number).divisor, 1);
  const auto& sources = system_->sources();
  const auto at = std::find(sources.begin(), sources.end(), input);
  if (at != sources.end()) source_ = static_cast<std::size_t>(at - sources.begin());
}

std::optional<Complex> PinResponse::at(RadPerSecond w) const {
  if (!obstacle_.empty()) return std::nullopt;
  if (!source_) return Complex(0.0);
  if (wire_) return Complex(1.0);
  const auto half = [&](int divisor) { return std::polar(1.0, -0.5 * w.value * divisor / master_.value); };
  // The input moves on in phase 2; how far depends on the clock that reads it: that of the output is taken.
  std::vector<ChargeSystem::Phases> sources(system_->sources().size());
  sources[*source_] = {1.0, std::conj(half(output_divisor_))};
  const auto solution = system_->solve(sources, half);
  if (!solution) return std::nullopt;
  const ChargeSystem::Phases& v = solution->at(output_);
  const Complex out = output_phase_ == 1 ? v.first : v.second * half(output_divisor_);
  if (!std::isfinite(out.real()) || !std::isfinite(out.imag())) return std::nullopt;
  return out;
}

}  // namespace bodesmith::fpaa::an231
