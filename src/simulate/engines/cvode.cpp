// The whole chain in CVODE. Runs of blocks that are an ODE are solved as one (ode_solve.hpp); between them
// stand pure delays, clocked blocks (edge by edge) and memory that depends on the rate (stepped eight times a
// sample, said in the notes), which work on the dense signal the run before them left.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "chain/kernel.hpp"
#include "signal/statistics.hpp"
#include "signal/time_record.hpp"
#include "simulate/engines/engine.hpp"
#include "simulate/ode/cvode_solver.hpp"
#include "simulate/ode/ode_solve.hpp"
#include "simulate/record/dense_signal.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {
namespace {

// Blocks that cannot stand in an ODE, from one dense signal to the next.

/// A time that is a sample of the record but for rounding is that exactly.
double snapped(double t, const TimeRecord& record) {
  const double at = (t - record.start_s) / record.step_s;
  const double whole = std::round(at);
  return whole >= 0.0 && std::abs(at - whole) < 1e-9 ? record.time_s(static_cast<std::size_t>(whole)) : t;
}

/// y(t) = u(t - delay); what was before the signal's begin comes first.
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

/// A memory that depends on the rate, moved along straight lines of at most `max_step_s`.
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

/// A clocked block, edge by edge. Edges that are samples of the record but for rounding are those exactly.
DenseSignal clocked(chain::SampledKernel& kernel, const DenseSignal& in, bool equilibrium,
                    const TimeRecord& record) {
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
    const double edge = snapped(begin + static_cast<double>(k) * cycle, record);
    if (edge > end) break;
    // What stands at an edge is what was there just before it, except at the very start.
    const double sample = reader.value(edge, k > 0);
    hold_until(snapped(edge + kernel.delay_s(), record));
    held = kernel.update(sample);
  }
  hold_until(end);
  return out;
}

using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::SampledKernel;

/// The signal on its way through the chain.
class ChainRun {
 public:
  ChainRun(const chain::Chain& chain, const TimeRecord& input, const Options& options);
  Result run();

 private:
  /// From block `first` on, as many as can stand in one ODE; returns the block behind them.
  std::size_t solve_from(std::size_t first);
  /// A block that stands between ODEs.
  void pass(std::size_t block);

  const chain::Chain& chain_;
  const Options& options_;
  std::size_t samples_;  ///< of the input
  bool equilibrium_;
  std::vector<Kernel> kernels_;
  bool right_limits_ = false;  ///< clocked blocks show their new value at an edge
  TimeRecord record_;
  std::vector<double> times_;
  DenseSignal signal_;
  double rest_ = 0.0;
  bool at_samples_ = false;  ///< result_.y is the signal's latest state, not signal_
  Result result_;
};

ChainRun::ChainRun(const chain::Chain& chain, const TimeRecord& input, const Options& options)
    : chain_(chain),
      options_(options),
      samples_(input.size()),
      equilibrium_(start_of(chain, options.start) == Start::equilibrium),
      record_(input) {
  result_.stats.engine = Engine::cvode;
  for (const chain::Block& block : chain.blocks) {
    const Kernel& kernel = kernels_.emplace_back(block.kernel());
    right_limits_ = right_limits_ || std::holds_alternative<std::unique_ptr<SampledKernel>>(kernel);
    if (const auto* k = std::get_if<LinearKernel>(&kernel)) result_.model_error += k->approximation_error;
  }
  record_.y.clear();
  if (record_.u.size() == 1 || right_limits_) record_.u.push_back(record_.u.back());  // the last edge shows
  times_ = record_.times_s();
  signal_ = DenseSignal::from_record(record_);
  rest_ = record_.u.front();
  signal_.before = equilibrium_ ? rest_ : 0.0;
}

std::size_t ChainRun::solve_from(std::size_t first) {
  std::size_t behind = first;
  std::vector<Kernel*> run;
  while (behind < kernels_.size() && can_stand_in_ode(kernels_[behind])) run.push_back(&kernels_[behind++]);
  OdeSystem system(run, signal_);
  rest_ = system.start(start_of(chain_, options_.start), rest_);
  OdeRequest request;
  request.right_limits = right_limits_;
  DenseSignal dense;
  at_samples_ = behind == kernels_.size();
  if (at_samples_) {
    request.times = times_;
    request.values = &result_.y;
  } else {
    request.dense = &dense;
  }
  solve_ode(system, options_, request, result_.stats, record_.step_s);
  dense.before = equilibrium_ ? rest_ : 0.0;
  if (!at_samples_) signal_ = std::move(dense);
  return behind;
}

void ChainRun::pass(std::size_t block) {
  at_samples_ = false;
  Kernel& kernel = kernels_[block];
  if (const auto* linear = std::get_if<LinearKernel>(&kernel)) {
    signal_ = delayed(signal_, linear->delay_s);
  } else if (auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernel)) {
    if (equilibrium_) rest_ = (*memory)->reset(rest_, true);
    signal_ = stepped(**memory, signal_, record_.step_s / 8.0, equilibrium_);
    result_.notes.push_back(
        fmt::format("block {} ({}) depends on the rate of its input and is stepped eight times a sample",
                    block + 1, chain_.blocks[block].type_name()));
  } else {
    SampledKernel& sampled = *std::get<std::unique_ptr<SampledKernel>>(kernel);
    if (equilibrium_) rest_ = sampled.reset(rest_, true);
    signal_ = clocked(sampled, signal_, equilibrium_, record_);
  }
  signal_.before = equilibrium_ ? rest_ : 0.0;
}

Result ChainRun::run() {
  for (std::size_t i = 0; i < kernels_.size();) {
    if (can_stand_in_ode(kernels_[i])) {
      i = solve_from(i);
    } else {
      pass(i++);
    }
  }
  if (!at_samples_) {
    result_.y.clear();
    DenseSignal::Reader reader(signal_);
    for (const double t : times_) result_.y.push_back(reader.value(t, !right_limits_ && t > times_.front()));
  }
  result_.y.resize(samples_);
  return std::move(result_);
}

Result run_in_cvode(const chain::Chain& chain, const TimeRecord& input, const Options& options) {
  try {
    return ChainRun(chain, input, options).run();
  } catch (const SolverFailure& failure) {
    throw InputError(fmt::format("the model cannot be solved for this input: {}", failure.what()));
  }
}

class CvodeEngine final : public ChainEngine {
 public:
  Engine which() const override { return Engine::cvode; }
  std::string_view method(const Kernel& kernel) const override {
    if (can_stand_in_ode(kernel)) return "one ODE with events";
    if (std::holds_alternative<LinearKernel>(kernel)) return "delay, shifted";
    if (std::holds_alternative<std::unique_ptr<SampledKernel>>(kernel)) return "edge by edge";
    return "memory, eight steps a sample";
  }
  std::variant<Result, NoClosedForm> run(const chain::Chain& chain, const TimeRecord& input,
                                         const Options& options) const override {
    return run_in_cvode(chain, input, options);
  }
  /// Largest change that a tenth of the tolerance makes.
  double estimate_error(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                        const Result& result) const override {
    return error_figures(result.y, run_in_cvode(chain, input, options.finer()).y).max;
  }
};

}  // namespace

BODESMITH_ENTRY(ChainEngine, cvode_engine, CvodeEngine)

std::optional<Result> second_opinion(const chain::Chain& chain, const TimeRecord& input,
                                     const Options& options) {
  constexpr std::size_t kMaxSamples = 100'000;
  if (input.size() > kMaxSamples) return std::nullopt;
  try {
    Result out = run_in_cvode(chain, input, options);
    if (options.estimate_error)
      out.error_estimate = cvode_engine().estimate_error(chain, input, options, out);
    return out;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace bodesmith::simulate
