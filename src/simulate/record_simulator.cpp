#include "simulate/record_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "chain/linear_kernel.hpp"
#include "simulate/branch_propagator.hpp"
#include "simulate/linear_propagator.hpp"
#include "simulate/ode_propagator.hpp"
#include "simulate/sampled_propagator.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::CurveKernel;
using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::OdeKernel;
using chain::SampledKernel;
using chain::SourceKernel;

/// Merged state spaces cost the square of their order.
constexpr std::size_t kMostMerged = 12;

/// One block with its kernel, rebuilt only when a parameter changed.
struct Slot {
  std::optional<Kernel> kernel;
  std::vector<double> values;

  void refresh(const Block& block) {
    const auto& parameters = block.parameters();
    bool same = kernel.has_value() && values.size() == parameters.size();
    for (size_t i = 0; same && i < values.size(); ++i) same = values[i] == parameters[i].value;
    if (same) return;
    values.resize(parameters.size());
    for (size_t i = 0; i < values.size(); ++i) values[i] = parameters[i].value;
    kernel = block.kernel();
  }
};

int order_of(const Kernel& kernel) {
  if (const auto* linear = std::get_if<LinearKernel>(&kernel)) return static_cast<int>(linear->order());
  if (const auto* ode = std::get_if<std::unique_ptr<OdeKernel>>(&kernel))
    return static_cast<int>((*ode)->linear().order());
  return 0;
}

/// Neighbouring linear blocks, or one block of another kind.
///
/// The delays of a linear run are moved to its end, where they are exact. What does not come from the input
/// must not be delayed with it: constants and initial states of blocks behind a delay run beside, in a system
/// of their own.
struct Stage {
  size_t first = 0;
  size_t end = 0;
  bool linear = false;
  LinearKernel merged;
  size_t front = 0;     ///< states of `merged` in front of its delay
  LinearKernel beside;  ///< driven by constants only; its states are those behind the delay
  size_t state = 0;     ///< place of its states among all states
};

/// Whether `next` may join: a second delay would hold back what runs beside, and the order stays small.
bool joins(const Stage& stage, const LinearKernel& next) {
  if (next.delay_s > 0.0 && (stage.beside.order() > 0 || stage.beside.offset != 0.0)) return false;
  return stage.merged.order() + next.order() <= kMostMerged || next.order() == 0;
}

void join(Stage& stage, LinearKernel next) {
  if (stage.merged.delay_s > 0.0) {
    stage.beside = chain::in_series(stage.beside, next);
    stage.beside.delay_s = 0.0;
    next.offset = 0.0;
    next.constant.clear();
  }
  stage.merged = chain::in_series(stage.merged, next);
  if (stage.merged.delay_s == 0.0) stage.front = stage.merged.order();
}

bool is_silent(const LinearKernel& k, const double* x) {
  return k.offset == 0.0 && k.constant.empty() &&
         std::all_of(x, x + k.order(), [](double v) { return v == 0.0; });
}

}  // namespace

struct RecordSimulator::Implementation {
  Chain chain;
  double step_s = 0.0;
  RecordOptions options;
  std::vector<chain::Parameter*> free;
  std::vector<Slot> slots;
  std::vector<Stage> stages;
  std::vector<double> initial;
  std::vector<double> state;
  std::vector<double> signal;
  std::vector<double> other;
  std::vector<double> third;
  std::vector<double> main_state;
  std::vector<double> beside_state;
  std::vector<double> output;
  LinearPropagator linear;
  OdePropagator ode;
  BranchPropagator branch;
  int degree = 1;
  double model_error = 0.0;
  bool diverged = false;

  void refresh(size_t blocks) {
    slots.resize(chain.blocks.size());
    size_t states = 0;
    model_error = 0.0;
    for (size_t i = 0; i < chain.blocks.size(); ++i) {
      slots[i].refresh(chain.blocks[i]);
      if (i >= blocks) continue;
      states += static_cast<size_t>(order_of(*slots[i].kernel));
      if (const auto* k = std::get_if<LinearKernel>(&*slots[i].kernel)) model_error += k->approximation_error;
    }
    initial.resize(std::max(initial.size(), states), 0.0);
    plan(blocks);
  }

  void plan(size_t blocks) {
    stages.clear();
    size_t state_at = 0;
    for (size_t i = 0; i < blocks; ++i) {
      const Kernel& kernel = *slots[i].kernel;
      const auto* k = std::get_if<LinearKernel>(&kernel);
      const bool extends =
          k != nullptr && !stages.empty() && stages.back().linear && joins(stages.back(), *k);
      if (!extends) {
        Stage stage;
        stage.first = i;
        stage.linear = k != nullptr;
        stage.state = state_at;
        if (k != nullptr) {
          stage.merged.d = 1.0;
          join(stage, *k);
        }
        stages.push_back(std::move(stage));
      } else {
        join(stages.back(), *k);
      }
      stages.back().end = i + 1;
      state_at += static_cast<size_t>(order_of(kernel));
    }
    degree = options.degree != 0 ? options.degree : needed_degree();
  }

  /// 1 while every signal that enters dynamics is a straight line over each hold, else 3.
  int needed_degree() const {
    bool straight = true;
    const double h = step_s / options.oversample;
    for (const Stage& stage : stages) {
      const Kernel& kernel = *slots[stage.first].kernel;
      if (stage.linear) {
        const double delay = stage.merged.delay_s / h;
        const bool whole = std::abs(delay - std::round(delay)) < 1e-12;
        const bool dynamics = stage.merged.order() > 0 || !whole;
        if (dynamics && !straight) return 3;
        if (dynamics) straight = false;
      } else if (std::holds_alternative<std::unique_ptr<OdeKernel>>(kernel)) {
        return 3;
      } else if (const auto* source = std::get_if<std::unique_ptr<SourceKernel>>(&kernel)) {
        straight = straight && (*source)->straight();
      } else if (std::holds_alternative<std::unique_ptr<CurveKernel>>(kernel)) {
        straight = false;
      } else {
        if (!straight) return 3;  // an extreme or an edge inside a hold is then met
        straight = false;
      }
    }
    return 1;
  }

  bool has_sampled() const {
    return std::any_of(stages.begin(), stages.end(), [&](const Stage& s) {
      return std::holds_alternative<std::unique_ptr<SampledKernel>>(*slots[s.first].kernel);
    });
  }

  void spread_input(std::span<const double> u, size_t holds, const HoldNodes& nodes) {
    const auto width = static_cast<size_t>(nodes.degree + 1);
    signal.resize(holds * width);
    other.resize(holds * width);
    const auto parts = static_cast<size_t>(options.oversample);
    double* out = signal.data();
    for (size_t i = 0; i + 1 < u.size(); ++i) {
      const double rise = u[i + 1] - u[i];
      for (size_t m = 0; m < parts; ++m) {
        for (size_t j = 0; j < width; ++j) {
          const bool last = m + 1 == parts && j + 1 == width;
          *out++ = last ? u[i + 1]
                        : u[i] + rise * ((static_cast<double>(m) + nodes.at[j]) / static_cast<double>(parts));
        }
      }
    }
    while (out < signal.data() + holds * width) *out++ = u.back();
  }

  std::span<const double> run(std::span<const double> u, size_t blocks) {
    diverged = false;
    output.resize(u.size());
    if (u.empty()) return output;
    refresh(std::min(blocks, chain.blocks.size()));
    const HoldNodes& nodes = hold_nodes(degree);
    const auto width = static_cast<size_t>(degree + 1);
    const auto parts = static_cast<size_t>(options.oversample);
    const bool right_limits = has_sampled();
    const size_t holds = (u.size() - 1) * parts + (right_limits || u.size() == 1 ? 1 : 0);
    const double h = step_s / static_cast<double>(parts);
    spread_input(u, holds, nodes);
    state.assign(initial.begin(), initial.end());
    const bool equilibrium = options.start == Start::equilibrium;
    double rest = u[0];  // what the signal rests at before the start
    for (size_t s = 0; s < stages.size(); ++s) {
      const Stage& stage = stages[s];
      Kernel& kernel = *slots[stage.first].kernel;
      double* x = state.data() + stage.state;
      if (stage.linear) {
        run_linear(stage, h, nodes, holds, equilibrium, rest, x);
      } else if (auto* curve = std::get_if<std::unique_ptr<CurveKernel>>(&kernel)) {
        (*curve)->values(signal.data(), signal.data(), holds * width);
        rest = (*curve)->value(rest);
      } else if (auto* source = std::get_if<std::unique_ptr<SourceKernel>>(&kernel)) {
        add_source(**source, h, nodes, holds);
        rest += (*source)->value(options.start_s);
      } else if (auto* dynamics = std::get_if<std::unique_ptr<OdeKernel>>(&kernel)) {
        run_ode(**dynamics, h, nodes, holds, equilibrium, rest, x);
      } else if (auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernel)) {
        run_memory(**memory, h, nodes, holds, equilibrium, rest);
      } else {
        auto& sampled = *std::get<std::unique_ptr<SampledKernel>>(kernel);
        run_sampled(sampled, nodes, h, signal.data(), other.data(), holds, equilibrium,
                    s + 1 == stages.size());
        std::swap(signal, other);
      }
    }
    if (right_limits) {
      for (size_t i = 0; i < u.size(); ++i) output[i] = signal[i * parts * width];
    } else {
      output[0] = signal[0];
      for (size_t i = 1; i < u.size(); ++i) output[i] = signal[i * parts * width - 1];
    }
    return output;
  }

  /// Output of a linear kernel at rest under u; adds its states at rest to x.
  static double at_rest(const LinearKernel& k, double u, double* x) {
    std::vector<double> still(k.order());
    equilibrium(k, u, still.data());
    double y = k.offset + k.d * u;
    for (size_t i = 0; i < still.size(); ++i) {
      y += k.c[i] * still[i];
      x[i] += still[i];
    }
    return y;
  }

  void run_linear(const Stage& stage, double h, const HoldNodes& nodes, size_t holds, bool equilibrium,
                  double& rest, double* x) {
    const LinearKernel& k = stage.merged;
    const bool delayed = k.delay_s > 0.0;
    // States behind the delay belong to what runs beside.
    main_state.assign(k.order(), 0.0);
    std::copy_n(x, delayed ? stage.front : k.order(), main_state.begin());
    beside_state.assign(stage.beside.order(), 0.0);
    std::copy_n(x + stage.front, stage.beside.order(), beside_state.begin());
    double before = 0.0;
    if (equilibrium) {
      before = at_rest(k, rest, main_state.data());
      rest = before + at_rest(stage.beside, 0.0, beside_state.data());
    }
    linear.prepare(k, h, nodes);
    linear.run(signal.data(), other.data(), holds, main_state.data(), before);
    if (delayed && !is_silent(stage.beside, beside_state.data())) {
      // `signal` is free now.
      linear.prepare(stage.beside, h, nodes);
      std::fill(signal.begin(), signal.end(), 0.0);
      third.resize(signal.size());
      linear.run(signal.data(), third.data(), holds, beside_state.data(), 0.0);
      for (size_t i = 0; i < other.size(); ++i) other[i] += third[i];
    }
    std::swap(signal, other);
  }

  void add_source(const SourceKernel& source, double h, const HoldNodes& nodes, size_t holds) {
    const auto width = static_cast<size_t>(nodes.degree + 1);
    double* v = signal.data();
    for (size_t hold = 0; hold < holds; ++hold) {
      for (size_t j = 0; j < width; ++j)
        *v++ += source.value(options.start_s + h * (static_cast<double>(hold) + nodes.at[j]));
    }
  }

  void run_ode(const OdeKernel& system, double h, const HoldNodes& nodes, size_t holds, bool equilibrium,
               double& rest, double* x) {
    const StateSpace& k = system.linear();
    if (equilibrium) {
      std::vector<double> still(k.order());
      system.equilibrium(rest, still.data());
      double y = k.offset + k.d * rest;
      for (size_t i = 0; i < still.size(); ++i) {
        y += k.c[i] * still[i];
        x[i] += still[i];
      }
      rest = y;
    }
    ode.effort = options.most_parts;
    ode.turn = options.most_turn_rad;
    ode.tolerance = options.newton_tolerance;
    ode.prepare(system, h, nodes);
    ode.run(system, signal.data(), other.data(), holds, x);
    diverged = diverged || ode.failures() > 0;
    std::swap(signal, other);
  }

  void run_memory(MemoryKernel& memory, double h, const HoldNodes& nodes, size_t holds, bool equilibrium,
                  double& rest) {
    if (branch.prepare(memory, h, nodes)) {
      rest = branch.run(signal.data(), holds, equilibrium ? signal[0] : 0.0);
      return;
    }
    const auto width = static_cast<size_t>(nodes.degree + 1);
    double gaps[kMaxDegree + 1] = {};
    for (size_t j = 1; j < width; ++j) gaps[j] = h * (nodes.at[j] - nodes.at[j - 1]);
    double* v = signal.data();
    const bool jumps = memory.jumps_at_turns();
    double last_in = v[0];
    double last_out = memory.reset(v[0], equilibrium);
    rest = last_out;
    for (size_t hold = 0; hold < holds; ++hold) {
      if (v[0] != last_in) last_out = memory.step(v[0], 0.0);
      const double first = v[0];
      last_in = v[width - 1];
      if (jumps && v[1] != first) last_out = memory.departing(v[1]);
      v[0] = last_out;
      for (size_t j = 1; j < width; ++j) v[j] = memory.step(v[j], gaps[j]);
      last_out = v[width - 1];
      v += width;
    }
  }
};

RecordSimulator::RecordSimulator(Chain chain, double step_s, RecordOptions options)
    : implementation_(std::make_unique<Implementation>()) {
  if (!(step_s > 0.0) || options.oversample < 1 || options.degree < 0 || options.degree > kMaxDegree) {
    throw std::logic_error("RecordSimulator: step, oversample or degree out of range");
  }
  implementation_->chain = std::move(chain);
  implementation_->step_s = step_s;
  implementation_->options = options;
  implementation_->free = implementation_->chain.free_parameters();
  implementation_->refresh(implementation_->chain.blocks.size());
}

RecordSimulator::~RecordSimulator() = default;
RecordSimulator::RecordSimulator(RecordSimulator&&) noexcept = default;
RecordSimulator& RecordSimulator::operator=(RecordSimulator&&) noexcept = default;

Chain& RecordSimulator::chain() {
  return implementation_->chain;
}
const Chain& RecordSimulator::chain() const {
  return implementation_->chain;
}
void RecordSimulator::set_free(std::size_t i, double value) {
  implementation_->free.at(i)->value = value;
}
std::span<double> RecordSimulator::initial_states() {
  return implementation_->initial;
}
std::span<const double> RecordSimulator::run(std::span<const double> u) {
  return implementation_->run(u, implementation_->chain.blocks.size());
}
std::span<const double> RecordSimulator::run_until(std::span<const double> u, std::size_t blocks) {
  return implementation_->run(u, blocks);
}
int RecordSimulator::degree() const {
  return implementation_->degree;
}
std::size_t RecordSimulator::holds_per_sample() const {
  return static_cast<std::size_t>(implementation_->options.oversample);
}
double RecordSimulator::model_error() const {
  return implementation_->model_error;
}
bool RecordSimulator::diverged() const {
  return implementation_->diverged;
}

}  // namespace bodesmith::simulate
