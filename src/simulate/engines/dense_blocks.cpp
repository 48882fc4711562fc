#include "simulate/engines/dense_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "simulate/work_limit.hpp"

namespace bodesmith::simulate {
namespace {

/// Times that are samples of the record but for rounding become them exactly.
class SampleGrid {
 public:
  explicit SampleGrid(const TimeRecord& record) : record_(record) {}
  double snapped(double t) const {
    const double at = (t - record_.start_s) / record_.step_s;
    const double whole = std::round(at);
    return whole >= 0.0 && std::abs(at - whole) < 1e-9 ? record_.time_s(static_cast<std::size_t>(whole)) : t;
  }

 private:
  const TimeRecord& record_;
};

}  // namespace

DenseSignal delayed(const DenseSignal& in, double delay) {
  DenseSignal out;
  out.before = in.before;
  const double begin = in.begin();
  const double end = in.end();
  DenseSignal::Piece first;
  first.begin = begin;
  first.end = std::min(begin + delay, end);
  first.nodes[0] = first.nodes[1] = in.before;
  out.append(first);
  for (const auto& piece : in.pieces()) {
    DenseSignal::Piece moved = piece;
    moved.begin += delay;
    moved.end += delay;
    if (moved.begin >= end) break;
    out.append(moved);
  }
  out.corner(begin + delay);
  for (const double t : in.corners()) out.corner(t + delay);
  return out;
}

DenseSignal stepped(chain::MemoryKernel& memory, const DenseSignal& in, double max_step_s, bool equilibrium) {
  DenseSignal out;
  DenseSignal::Reader reader(in);
  double y = memory.reset(reader.value(in.begin()), equilibrium);
  for (const auto& piece : in.pieces()) {
    const double length = piece.end - piece.begin;
    const int parts = whole_number(std::ceil(length / max_step_s - 1e-9), 1);
    const HoldNodes& nodes = hold_nodes(piece.degree);
    for (int i = 0; i < parts; ++i) {
      DenseSignal::Piece line;
      line.begin = piece.begin + length * i / parts;
      line.end = i + 1 == parts ? piece.end : piece.begin + length * (i + 1) / parts;
      line.nodes[0] = y;
      y = memory.step(nodes.value(piece.nodes, static_cast<double>(i + 1) / parts), length / parts);
      line.nodes[1] = y;
      if (line.end > line.begin) out.append(line);
    }
  }
  for (const double t : in.corners()) out.corner(t);
  return out;
}

DenseSignal clocked(chain::SampledKernel& kernel, const DenseSignal& in, bool equilibrium,
                    const TimeRecord& record) {
  const SampleGrid grid(record);
  DenseSignal out;
  DenseSignal::Reader reader(in);
  const double begin = in.begin();
  const double end = in.end();
  require_few_edges((end - begin) * kernel.clock_hz(),
                    fmt::format("a clock of {} Hz", rounded_text(kernel.clock_hz())));
  const double cycle = 1.0 / kernel.clock_hz();
  double held = kernel.reset(reader.value(begin), equilibrium);
  double from = begin;
  const auto hold_until = [&](double t) {
    t = std::min(t, end);
    if (!(t > from)) return;
    DenseSignal::Piece piece;
    piece.begin = from;
    piece.end = t;
    piece.nodes[0] = piece.nodes[1] = held;
    out.append(piece);
    out.corner(t);
    from = t;
  };
  for (std::size_t k = 0;; ++k) {
    const double edge = grid.snapped(begin + static_cast<double>(k) * cycle);
    if (edge > end) break;
    // What stands at an edge is what was there just before it, except at the very start.
    const double sample = reader.value(edge, k > 0);
    hold_until(grid.snapped(edge + kernel.delay_s()));
    held = kernel.update(sample);
  }
  hold_until(end);
  return out;
}

}  // namespace bodesmith::simulate
