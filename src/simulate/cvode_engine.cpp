#include "simulate/cvode_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "simulate/dense_signal.hpp"
#include "simulate/ode_run.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::SampledKernel;

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

DenseSignal stepped(MemoryKernel& memory, const DenseSignal& in, double longest, bool equilibrium) {
  DenseSignal out;
  DenseSignal::Reader reader(in);
  double y = memory.reset(reader.value(in.begin()), equilibrium);
  for (const auto& piece : in.pieces()) {
    const double length = piece.end - piece.begin;
    const int parts = std::max(1, static_cast<int>(std::ceil(length / longest - 1e-9)));
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

DenseSignal clocked(SampledKernel& kernel, const DenseSignal& in, bool equilibrium, const SampleGrid& grid) {
  DenseSignal out;
  DenseSignal::Reader reader(in);
  const double begin = in.begin();
  const double end = in.end();
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

}  // namespace

bool can_stand_in_ode(const Kernel& kernel) {
  if (const auto* linear = std::get_if<LinearKernel>(&kernel)) return linear->delay_s == 0.0;
  if (const auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernel)) {
    return (*memory)->rate_independent() || (*memory)->slew_rate() > 0.0;
  }
  return !std::holds_alternative<std::unique_ptr<SampledKernel>>(kernel);
}

std::vector<double> run_cvode_engine(const chain::Chain& chain, const TimeRecord& input,
                                     const Options& options, Stats& stats, std::vector<std::string>& notes,
                                     double& model_error) {
  std::vector<Kernel> kernels;
  bool right_limits = false;
  model_error = 0.0;
  for (const chain::Block& block : chain.blocks) {
    kernels.push_back(block.kernel());
    right_limits = right_limits || std::holds_alternative<std::unique_ptr<SampledKernel>>(kernels.back());
    if (const auto* k = std::get_if<LinearKernel>(&kernels.back())) model_error += k->approximation_error;
  }
  TimeRecord record = input;
  record.y.clear();
  if (record.u.size() == 1 || right_limits)
    record.u.push_back(record.u.back());  // so that the last edge shows
  std::vector<double> times;
  for (std::size_t i = 0; i < record.size(); ++i) times.push_back(record.time_s(i));

  DenseSignal signal = DenseSignal::from_record(record);
  const bool equilibrium = options.start == Start::equilibrium;
  double rest = record.u.front();
  signal.before = equilibrium ? rest : 0.0;
  std::vector<double> values;
  bool at_samples = false;  // whether `values` is the signal's latest state
  for (std::size_t i = 0; i < kernels.size();) {
    at_samples = false;
    if (can_stand_in_ode(kernels[i])) {
      std::vector<Kernel*> run;
      while (i < kernels.size() && can_stand_in_ode(kernels[i])) run.push_back(&kernels[i++]);
      OdeRun ode(run, signal);
      ode.start(options.start, rest);
      OdeRun::Wanted wanted;
      wanted.right_limits = right_limits;
      DenseSignal dense;
      if (i == kernels.size()) {
        wanted.times = times;
        wanted.values = &values;
        at_samples = true;
      } else {
        wanted.dense = &dense;
      }
      ode.solve(options, wanted, stats, input.step_s);
      dense.before = equilibrium ? rest : 0.0;
      if (!at_samples) signal = std::move(dense);
      continue;
    }
    Kernel& kernel = kernels[i++];
    if (const auto* linear = std::get_if<LinearKernel>(&kernel)) {
      signal = delayed(signal, linear->delay_s);
    } else if (auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernel)) {
      if (equilibrium) rest = (*memory)->reset(rest, true);
      signal = stepped(**memory, signal, input.step_s / 8.0, equilibrium);
      signal.before = equilibrium ? rest : 0.0;
      notes.push_back(
          fmt::format("block {} ({}) depends on the rate of its input and is stepped eight times a sample", i,
                      chain.blocks[i - 1].type_name()));
    } else {
      auto& sampled = *std::get<std::unique_ptr<SampledKernel>>(kernel);
      if (equilibrium) rest = sampled.reset(rest, true);
      signal = clocked(sampled, signal, equilibrium, SampleGrid(record));
      signal.before = equilibrium ? rest : 0.0;
    }
  }
  if (!at_samples) {
    values.clear();
    DenseSignal::Reader reader(signal);
    for (const double t : times) values.push_back(reader.value(t, !right_limits && t > times.front()));
  }
  values.resize(input.size());
  return values;
}

}  // namespace bodesmith::simulate
