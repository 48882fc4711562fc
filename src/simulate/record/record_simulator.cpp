#include "simulate/record/record_simulator.hpp"

#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "simulate/propagators/branch.hpp"
#include "simulate/propagators/collocation.hpp"
#include "simulate/propagators/linear.hpp"
#include "simulate/propagators/sampled.hpp"
#include "simulate/record/record_plan.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::CurveKernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::OdeKernel;
using chain::SampledKernel;
using chain::SourceKernel;

/// From rest and without an input.
bool is_silent(const LinearKernel& k) {
  return k.offset == 0.0 && k.constant.empty();
}

/// Output of a linear kernel at rest under u, and its states there.
double rest_of(const StateSpace& k, double u, std::vector<double>& x) {
  equilibrium(k, u, x.data());
  return output(k, u, x.data());
}

}  // namespace

struct RecordSimulator::Implementation {
  // What one run is about.
  struct Run {
    const HoldNodes& nodes;
    HoldPlan plan;
    bool equilibrium = false;
    double rest = 0.0;                   ///< what the signal rests at before the start
    BranchPropagator::Place place = {};  ///< of the stage now

    /// Of a chain with clocks, whose holds are all alike.
    const HoldSpan& only_span() const { return plan.spans.front(); }
    std::size_t values() const {
      std::size_t holds = 0;
      for (const HoldSpan& span : plan.spans) holds += span.holds;
      return holds * nodes.size();
    }
    std::optional<double> rested() const { return equilibrium ? std::optional(rest) : std::nullopt; }
  };

  /// A run as it stood in front of a stage: RecordOptions::same_input.
  struct Kept {
    bool good = false;
    std::vector<double> signal;
    double rest = 0.0;
    Outcome outcome = Outcome::finished;
  };

  Chain chain;
  double step_s = 0.0;
  RecordOptions options;
  Start start = Start::zero;
  std::vector<KernelSlot> slots;
  std::vector<RecordStage> stages;
  std::vector<double> signal;
  std::vector<double> other;
  std::vector<double> third;
  std::vector<double>
      jumps;  ///< of a clock, in addition to the polynomials that stand for them (spread_steps); else empty
  StepSignal held;       ///< the signal behind a clock, as long as only values change on its way
  bool is_held = false;  ///< whether it is that
  std::vector<double> main_state;
  std::vector<double> undelayed_state;
  std::vector<double> result;
  std::vector<PreparedPropagators>
      linear;  ///< by a stage's first block; a second one for what runs alongside
  CollocationPropagator collocation;
  BranchPropagator branch;
  std::size_t degree = 1;
  double model_error = 0.0;
  Outcome outcome = Outcome::finished;
  std::vector<Kept> kept;  ///< one a block, in front of it
  std::span<const double> kept_input;
  std::size_t kept_degree = 0;
  std::vector<HoldSpan> kept_spans;

  /// What was kept behind a block that changed is no longer so.
  void forget_behind(std::size_t block) {
    for (std::size_t i = block + 1; i < kept.size(); ++i) kept[i].good = false;
  }

  void refresh(std::size_t blocks) {
    slots.resize(chain.blocks.size());
    model_error = 0.0;
    for (std::size_t i = 0; i < chain.blocks.size(); ++i) {
      if (slots[i].refresh(chain.blocks[i])) forget_behind(i);
      if (i >= blocks) continue;
      if (const auto* k = std::get_if<LinearKernel>(&slots[i].kernel()))
        model_error += k->approximation_error;
    }
    stages = record_stages(slots, blocks);
    const double h = step_s / static_cast<double>(options.oversample);
    degree = needed_degree(stages, slots, h);
  }

  bool is_sampled(const RecordStage& stage) const {
    return std::holds_alternative<std::unique_ptr<SampledKernel>>(slots[stage.first].kernel());
  }
  bool has_sampled() const {
    return std::ranges::any_of(stages, [&](const RecordStage& s) { return is_sampled(s); });
  }

  void spread_input(std::span<const double> u, const Run& run) {
    signal.resize(run.values());
    other.resize(run.values());
    double* out = signal.data();
    std::size_t hold = 0, i = 0;
    double from = 0.0;  // of the sample interval i
    for (const HoldSpan& span : run.plan.spans) {
      const double part = span.h / step_s;
      for (std::size_t n = 0; n < span.holds && i < run.plan.ends.size(); ++n) {
        for (const double at : run.nodes.places()) *out++ = u[i] + (u[i + 1] - u[i]) * (from + part * at);
        from += part;
        if (++hold < run.plan.ends[i]) continue;
        out[-1] = u[++i];
        from = 0.0;
      }
    }
    std::fill(out, signal.data() + signal.size(), u.back());
  }

  /// Whether the values at the samples are all that is needed: linear dynamics under an input that is straight
  /// between them, and what works value by value.
  bool needs_samples_only() const {
    if (options.oversample != 1 || degree != 1) return false;
    return std::ranges::all_of(stages, [&](const RecordStage& stage) {
      if (!stage.linear) {
        const auto& kernel = slots[stage.first].kernel();
        return std::holds_alternative<std::unique_ptr<CurveKernel>>(kernel) ||
               std::holds_alternative<std::unique_ptr<SourceKernel>>(kernel);
      }
      const double delay = stage.merged.delay_s / step_s;
      return std::abs(delay - std::round(delay)) < 1e-12 && is_silent(stage.undelayed);
    });
  }

  /// What rounding may have done to the last run: that of a step, grown by the modes' cancellation, which a mode that
  /// remembers many steps adds up at random.
  double rounding_error(std::span<const double> y) {
    // In vectors: one by one this took a third of a million samples' time.
    const double size =
        Eigen::Map<const Eigen::ArrayXd>(y.data(), static_cast<Eigen::Index>(y.size())).abs().maxCoeff();
    double factor = 1.0;
    for (const RecordStage& stage : stages) {
      if (!stage.linear || stage.merged.order() == 0) continue;
      LinearKernel k = stage.merged;
      k.delay_s = 0.0;
      const LinearPropagator& by = linear_of(stage).of(k, step_s, hold_nodes(1));
      const double steps = std::min(1.0 / (by.slowest_rad_s() * step_s), static_cast<double>(y.size()));
      factor *=
          by.condition() * (static_cast<double>(stage.merged.order()) + std::sqrt(std::max(steps, 1.0)));
    }
    return 4.0 * std::numeric_limits<double>::epsilon() * factor * size;
  }

  std::span<const double> run_samples(std::span<const double> u) {
    result.assign(u.begin(), u.end());
    double rest = u[0];
    for (const RecordStage& stage : stages) {
      if (stage.linear) {
        run_linear_samples(stage, rest);
      } else {
        std::visit([&](auto& kernel) { run_sample_values(kernel, rest); }, slots[stage.first].kernel());
      }
    }
    return result;
  }

  void run_linear_samples(const RecordStage& stage, double& rest) {
    LinearKernel k = stage.merged;
    const auto delay = static_cast<std::size_t>(
        std::min(std::round(k.delay_s / step_s), static_cast<double>(result.size())));
    k.delay_s = 0.0;
    main_state.assign(k.order(), 0.0);
    double before = 0.0;
    if (start == Start::equilibrium) rest = before = rest_of(k, rest, main_state);
    linear_of(stage)
        .of(k, step_s, hold_nodes(1))
        .run_samples(result.data(), result.size() - delay, main_state.data());
    if (delay == 0) return;
    std::copy_backward(result.begin(), result.end() - static_cast<std::ptrdiff_t>(delay), result.end());
    std::fill_n(result.begin(), delay, before);
  }

  void run_sample_values(std::unique_ptr<CurveKernel>& curve, double& rest) {
    curve->values(result.data(), result.data(), result.size());
    rest = curve->value(rest);
  }
  void run_sample_values(std::unique_ptr<SourceKernel>& source, double& rest) {
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] += source->value(options.start_s + step_s * static_cast<double>(i));
    rest += source->value(options.start_s);
  }
  template <class Other>
  void run_sample_values(Other& /*kernel*/, double& /*rest*/) {
    throw std::logic_error("a block with memory among values at samples");
  }

  std::span<const double> run(std::span<const double> u, std::size_t blocks) {
    outcome = Outcome::finished;
    if (u.empty()) {
      result.clear();
      return result;
    }
    refresh(std::min(blocks, chain.blocks.size()));
    if (needs_samples_only()) return run_samples(u);
    result.resize(u.size());
    const bool right_limits = has_sampled();
    Run run{hold_nodes(degree), plan_holds(stages, slots, u, step_s, options.oversample),
            start == Start::equilibrium, u[0]};
    if (run.plan.spans.empty()) run.plan.spans.push_back({0, step_s});
    if (right_limits || u.size() == 1) ++run.plan.spans.back().holds;
    Progress progress("simulation");
    const auto count = static_cast<double>(stages.size());
    std::size_t i = go_on_from_kept(u, run);
    if (i == 0) spread_input(u, run);
    is_held = false;
    for (bool keeps = options.same_input; i < stages.size(); ++i) {
      progress.at(static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
      // What a clock shows depends on the stages behind it.
      keeps = keeps && !is_sampled(stages[i]);
      run_stage(stages[i], run);
      if (keeps && i + 1 < stages.size() && !works_by_values(stages[i])) keep(stages[i + 1].first, run);
    }
    if (is_held) spread(run, true);
    // At a jump the value behind it (a clocked block's new output) or in front.
    result[0] = signal[0];
    for (std::size_t k = 1; k < u.size(); ++k)
      result[k] = signal[run.plan.ends[k - 1] * run.nodes.size() - (right_limits ? 0 : 1)];
    return result;
  }

  void keep(std::size_t block, const Run& run) {
    Kept& here = kept[block];
    here.signal.assign(signal.begin(), signal.end());
    here.rest = run.rest;
    here.outcome = outcome;
    here.good = true;
  }

  /// The stage from which the run goes on, with what was kept in front of it; 0: none was.
  std::size_t go_on_from_kept(std::span<const double> u, Run& run) {
    if (!options.same_input) return 0;
    if (u.data() != kept_input.data() || u.size() != kept_input.size() || degree != kept_degree ||
        run.plan.spans != kept_spans)
      kept.assign(chain.blocks.size(), {});
    kept_input = u;
    kept_degree = degree;
    kept_spans = run.plan.spans;
    for (std::size_t i = stages.size(); i-- > 1;) {
      const Kept& here = kept[stages[i].first];
      if (!here.good) continue;
      signal.assign(here.signal.begin(), here.signal.end());
      other.resize(signal.size());
      run.rest = here.rest;
      outcome = here.outcome;
      return i;
    }
    return 0;
  }

  void run_stage(const RecordStage& stage, Run& run) {
    if (is_held) {
      if (run_held(stage, run)) return;
      spread(run, has_memory(stage) || (works_by_values(stage) && shows_at_nodes_only(stage)));
    }
    if (stage.linear) return run_linear(stage, run);
    jumps.clear();
    run.place = {is_kinked(stage), shows_at_nodes_only(stage)};
    std::visit([&](auto& kernel) { run_kernel(kernel, run); }, slots[stage.first].kernel());
  }

  /// Whether what reaches this stage has corners between the nodes: of curves, memory and clocks, until dynamics take them off.
  bool is_kinked(const RecordStage& stage) const {
    for (auto before = stages.begin() + (&stage - stages.data()); before-- != stages.begin();) {
      const chain::Kernel& kernel = slots[before->first].kernel();
      const auto* ode = std::get_if<std::unique_ptr<OdeKernel>>(&kernel);
      if (before->linear ? before->merged.order() > 0 && before->merged.d == 0.0
                         : ode != nullptr && (*ode)->linear().d == 0.0)
        return false;
      if (const auto* curve = std::get_if<std::unique_ptr<CurveKernel>>(&kernel)) {
        if (!(*curve)->corners().empty()) return true;
      } else if (has_memory(*before) || is_sampled(*before)) {
        return true;
      }
    }
    return false;
  }

  /// Of steps to steps, or to the nodes behind a slew limit; false, and nothing done, where the nodes are needed.
  bool run_held(const RecordStage& stage, Run& run) {
    if (stage.linear) {
      if (!works_by_values(stage)) return false;
      for (double& v : held.value) v = stage.merged.d * v + stage.merged.offset;
      run.rest = stage.merged.d * run.rest + stage.merged.offset;
      return true;
    }
    chain::Kernel& kernel = slots[stage.first].kernel();
    if (auto* curve = std::get_if<std::unique_ptr<CurveKernel>>(&kernel)) {
      (*curve)->values(held.value.data(), held.value.data(), held.value.size());
      run.rest = (*curve)->value(run.rest);
      return true;
    }
    auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernel);
    if (memory == nullptr) return false;
    if ((*memory)->rate_independent()) {
      run.rest = run_memory(**memory, held, run.rested());
      return true;
    }
    if (!((*memory)->slew_rate() > 0.0)) return false;
    const HoldSpan& all = run.only_span();
    run.rest = run_memory(**memory, held, run.nodes, all.h, all.holds, run.rested(), signal.data());
    is_held = false;
    return true;
  }

  /// From steps to nodes.
  void spread(const Run& run, bool values_only) {
    is_held = false;
    if (!values_only) jumps.resize(signal.size());
    spread_steps(held, run.nodes, signal.data(), run.only_span().holds, values_only ? nullptr : jumps.data());
  }

  bool has_memory(const RecordStage& stage) const {
    return !stage.linear &&
           std::holds_alternative<std::unique_ptr<MemoryKernel>>(slots[stage.first].kernel());
  }
  bool works_by_values(const RecordStage& stage) const {
    if (stage.linear) return stage.merged.order() == 0 && stage.merged.delay_s == 0.0;
    const auto& kernel = slots[stage.first].kernel();
    return std::holds_alternative<std::unique_ptr<CurveKernel>>(kernel) ||
           std::holds_alternative<std::unique_ptr<SourceKernel>>(kernel);
  }
  /// Of a stage's output the values at the nodes count, not what it is in between: no dynamics follow; or memory does, which
  /// would take the overshoot of a polynomial near a step for a turn.
  bool shows_at_nodes_only(const RecordStage& stage) const {
    const auto behind = stages.begin() + (&stage - stages.data()) + 1;
    if (behind != stages.end() && has_memory(*behind)) return true;
    return std::all_of(behind, stages.end(), [this](const RecordStage& s) { return works_by_values(s); });
  }

  void run_linear(const RecordStage& stage, Run& run) {
    const LinearKernel& k = stage.merged;
    const bool delayed = k.delay_s > 0.0;
    main_state.assign(k.order(), 0.0);
    undelayed_state.assign(stage.undelayed.order(), 0.0);
    double before = 0.0;
    if (run.equilibrium) {
      before = rest_of(k, run.rest, main_state);
      run.rest = before + rest_of(stage.undelayed, 0.0, undelayed_state);
    }
    run_linear(linear_of(stage), k, run, signal.data(), other.data(), main_state.data(), before);
    if (delayed && !is_silent(stage.undelayed)) {
      // `signal` is free now.
      std::ranges::fill(signal, 0.0);
      third.resize(signal.size());
      run_linear(linear_of(stage, 1), stage.undelayed, run, signal.data(), third.data(),
                 undelayed_state.data(), 0.0);
      for (std::size_t i = 0; i < other.size(); ++i) other[i] += third[i];
    }
    // Its states have seen the steps of a clock right; what goes straight through shows them where they are.
    if (jumps.size() == other.size() && !delayed && shows_at_nodes_only(stage)) {
      for (std::size_t i = 0; i < other.size(); ++i) other[i] += k.d * jumps[i];
    }
    jumps.clear();
    std::swap(signal, other);
  }

  PreparedPropagators& linear_of(const RecordStage& stage, std::size_t second = 0) {
    linear.resize(2 * chain.blocks.size());
    return linear[2 * stage.first + second];
  }

  static void run_linear(PreparedPropagators& by, const LinearKernel& k, const Run& run, const double* u,
                         double* y, double* x, double before) {
    for (const HoldSpan& span : run.plan.spans) {
      by.of(k, span.h, run.nodes, run.plan.spans.size() > 1).run(u, y, span.holds, x, before);
      u += span.holds * run.nodes.size();
      y += span.holds * run.nodes.size();
    }
  }

  void run_kernel(LinearKernel&, Run&) { throw std::logic_error("a linear block outside a linear stage"); }

  void run_kernel(std::unique_ptr<CurveKernel>& curve, Run& run) {
    curve->values(signal.data(), signal.data(), run.values());
    run.rest = curve->value(run.rest);
  }

  void run_kernel(std::unique_ptr<SourceKernel>& source, Run& run) {
    double* v = signal.data();
    double from = options.start_s;
    for (const HoldSpan& span : run.plan.spans) {
      for (std::size_t hold = 0; hold < span.holds; ++hold) {
        for (std::size_t j = 0; j < run.nodes.size(); ++j)
          *v++ += source->value(from + span.h * (static_cast<double>(hold) + run.nodes.at[j]));
      }
      from += span.h * static_cast<double>(span.holds);
    }
    run.rest += source->value(options.start_s);
  }

  void run_kernel(std::unique_ptr<OdeKernel>& system, Run& run) {
    main_state.assign(system->linear().order(), 0.0);
    double* const x = main_state.data();
    if (run.equilibrium) {
      system->equilibrium(run.rest, x);
      run.rest = output(system->linear(), run.rest, x);
    }
    const double* u = signal.data();
    double* y = other.data();
    for (const HoldSpan& span : run.plan.spans) {
      // The turn of a sample interval chooses the steps, so that holds of half the length are in steps of half the length.
      const double turn = options.max_turn_rad / static_cast<double>(options.oversample);
      collocation.prepare(*system, span.h, {options.max_parts, turn, options.newton_tolerance});
      switch (collocation.run(*system, u, y, span.holds, x)) {
        case CollocationPropagator::Outcome::finished:
          break;
        case CollocationPropagator::Outcome::too_many_parts:
          outcome = Outcome::too_many_parts;
          break;
        case CollocationPropagator::Outcome::not_finite:
          outcome = Outcome::not_finite;
          break;
      }
      u += span.holds * run.nodes.size();
      y += span.holds * run.nodes.size();
    }
    std::swap(signal, other);
  }

  void run_kernel(std::unique_ptr<MemoryKernel>& memory, Run& run) {
    run.rest = memory->has_branches()
                   ? branch.run(*memory, run.nodes, run.plan.spans, signal.data(), run.rested().value_or(0.0),
                                run.place)
                   : run_memory(*memory, run.nodes, run.plan.spans, signal.data(), run.rested());
  }

  void run_kernel(std::unique_ptr<SampledKernel>& sampled, Run& run) {
    const HoldSpan& all = run.only_span();
    require_few_edges(sampled->clock_hz() * all.h * static_cast<double>(all.holds),
                      fmt::format("a clock of {} Hz", rounded_text(sampled->clock_hz())));
    run_sampled(*sampled, run.nodes, all.h, signal.data(), all.holds, run.equilibrium, held);
    is_held = true;
    if (run.equilibrium) run.rest = sampled->reset(run.rest, true);
  }
};

RecordSimulator::RecordSimulator(Chain chain, double step_s, RecordOptions options)
    : implementation_(std::make_unique<Implementation>()) {
  if (!(step_s > 0.0) || options.oversample < 1) {
    throw std::logic_error("RecordSimulator: step or oversample out of range");
  }
  implementation_->chain = std::move(chain);
  implementation_->step_s = step_s;
  implementation_->options = options;
  implementation_->start = start_of(implementation_->chain, options.start);
  implementation_->refresh(implementation_->chain.blocks.size());
}

RecordSimulator::~RecordSimulator() = default;
RecordSimulator::RecordSimulator(RecordSimulator&&) noexcept = default;
RecordSimulator& RecordSimulator::operator=(RecordSimulator&&) noexcept = default;

Chain& RecordSimulator::chain() {
  return implementation_->chain;
}
std::span<const double> RecordSimulator::run(std::span<const double> u) {
  return implementation_->run(u, implementation_->chain.blocks.size());
}
std::vector<double> RecordSimulator::run_once(std::span<const double> u) {
  run(u);
  return std::move(implementation_->result);
}
std::span<const double> RecordSimulator::run_until(std::span<const double> u, std::size_t blocks) {
  return implementation_->run(u, blocks);
}
RecordSimulator::Outcome RecordSimulator::outcome() const {
  return implementation_->outcome;
}
std::size_t RecordSimulator::degree() const {
  return implementation_->degree;
}
std::optional<double> RecordSimulator::rounding_error(std::span<const double> y) const {
  if (!implementation_->needs_samples_only()) return std::nullopt;
  return implementation_->rounding_error(y);
}
double RecordSimulator::model_error() const {
  return implementation_->model_error;
}

}  // namespace bodesmith::simulate
