#include "simulate/feedback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <variant>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/kernel.hpp"
#include "chain/sections_chain.hpp"
#include "filters/equalisers.hpp"
#include "signal/statistics.hpp"
#include "simulate/hold_response.hpp"
#include "simulate/ode/cvode_solver.hpp"
#include "simulate/ode/ode_solve.hpp"
#include "simulate/record/dense_signal.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Kernel;
using chain::LinearKernel;

/// A loop round a linear plant in closed form. Continuous controller: plant, integral and derivative filter
/// are one linear system driven by r and f,
///   x' = A x + b (f + control),  y = c x + y0,  e = r - y,
///   I' = ki e,  q' = w_d (e - q),  control = kp e + I + kd w_d (e - q),
/// stepped by its matrix exponential (hold_response.hpp). Sampled controller: the plant alone is stepped, its
/// drive a straight line plus the held control.
///
/// `parts` steps are taken where one would do; the difference between one and two is rounding. No closed form
/// when the plant is not linear or has a delay, when a continuous controller has limits, or when the
/// controller's period and the record's step are not whole multiples of each other.
using LoopOutcome = std::variant<LoopResult, NoClosedForm>;

/// x' = A x + sum_q b_q v_q + constant over one step, each v_q a straight line.
class Stepper {
 public:
  Stepper(const StateSpace& system, std::span<const double* const> inputs, double step_s)
      : next_(system.order()) {
    HoldResponseSolver().solve(driven(system, inputs), step_s, hold_nodes(1), 1.0, response_);
  }

  /// v: begin and end of each input.
  void step(std::vector<double>& x, std::initializer_list<std::pair<double, double>> v) {
    const std::size_t n = next_.size();
    for (std::size_t i = 0; i < n; ++i) {
      double sum = response_.k[i];
      const double* e = response_.e.data() + i * n;
      for (std::size_t j = 0; j < n; ++j) sum += e[j] * x[j];
      std::size_t q = 0;
      for (const auto& [begin, end] : v) {
        sum += response_.g[q][2 * i] * begin + response_.g[q][2 * i + 1] * end;
        ++q;
      }
      next_[i] = sum;
    }
    std::swap(x, next_);
  }

 private:
  HoldResponse response_;
  std::vector<double> next_;
};

/// begin + (end - begin) i/count.
double between(double begin, double end, int i, int count) {
  return i == count ? end : begin + (end - begin) * i / count;
}

/// Plant and continuous controller as one system driven by the feed-forward signal and the reference.
struct ClosedLoop {
  StateSpace system;
  std::vector<double> by_feedforward;
  std::vector<double> by_reference;
};

ClosedLoop closed_loop(const StateSpace& plant, const PidController& c, double direct, double wd) {
  const std::size_t n = plant.order();
  const std::size_t size = n + kPidStates;
  ClosedLoop out;
  StateSpace& closed = out.system;
  closed.a.assign(size * size, 0.0);
  closed.b.assign(size, 0.0);
  closed.constant.assign(size, 0.0);
  out.by_feedforward.assign(size, 0.0);
  out.by_reference.assign(size, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    double* row = closed.a.data() + i * size;
    for (std::size_t j = 0; j < n; ++j) row[j] = plant.a[i * n + j] - plant.b[i] * direct * plant.c[j];
    row[n] = plant.b[i];
    row[n + 1] = -plant.b[i] * c.derivative_s * wd;
    out.by_feedforward[i] = plant.b[i];
    out.by_reference[i] = plant.b[i] * direct;
    if (!plant.constant.empty()) closed.constant[i] = plant.constant[i];
    closed.a[n * size + i] = -c.integral_per_s * plant.c[i];
    closed.a[(n + 1) * size + i] = -wd * plant.c[i];
  }
  closed.a[(n + 1) * size + n + 1] = -wd;
  out.by_reference[n] = c.integral_per_s;
  out.by_reference[n + 1] = wd;
  for (std::size_t i = 0; i < size; ++i) closed.constant[i] -= out.by_reference[i] * plant.offset;
  return out;
}

void run_continuous(const StateSpace& plant, const std::vector<double>& f, const PidController& c,
                    const TimeRecord& r, int parts, std::vector<double> state, LoopResult& out) {
  const std::size_t n = plant.order();
  const double wd = c.derivative_s == 0.0 ? 0.0 : c.derivative_corner.rad_s().value;
  const double direct = c.proportional + c.derivative_s * wd;
  const ClosedLoop closed = closed_loop(plant, c, direct, wd);
  const std::array inputs = {closed.by_feedforward.data(), closed.by_reference.data()};
  Stepper stepper(closed.system, inputs, r.step_s / parts);
  state.resize(n + kPidStates, 0.0);
  Progress progress("simulation");
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (i % 65536 == 0) {
      stop_if_interrupted();
      progress.at(static_cast<double>(i) / static_cast<double>(r.size()));
    }
    for (int part = 0; i > 0 && part < parts; ++part) {
      stepper.step(
          state, {{between(f[i - 1], f[i], part, parts), between(f[i - 1], f[i], part + 1, parts)},
                  {between(r.u[i - 1], r.u[i], part, parts), between(r.u[i - 1], r.u[i], part + 1, parts)}});
    }
    const double y = output(plant, 0.0, state.data());
    const double error = r.u[i] - y;
    out.y.push_back(y);
    out.drive.push_back(f[i] + direct * error + state[n] - c.derivative_s * wd * state[n + 1]);
  }
  out.stats.steps = (r.size() - 1) * static_cast<std::size_t>(parts);
}

/// `edges` clock edges a sample interval, or one in `interval` samples.
void run_sampled_controller(const StateSpace& plant, const std::vector<double>& f, const PidController& c,
                            const TimeRecord& r, int edges, std::size_t interval, int parts,
                            std::vector<double> state, LoopResult& out) {
  const int pieces = edges * parts;
  const std::size_t look_every = std::max<std::size_t>(1, 65536 / static_cast<std::size_t>(pieces));
  const std::array<const double*, 1> inputs = {plant.b.data()};
  Stepper stepper(plant, inputs, r.step_s / pieces);
  SampledPid pid(c);
  double held = pid.update(r.u[0] - output(plant, 0.0, state.data()));
  out.y.push_back(output(plant, 0.0, state.data()));
  out.drive.push_back(f[0] + held);
  Progress progress("simulation");
  for (std::size_t i = 1; i < r.size(); ++i) {
    if (i % look_every == 0) {
      stop_if_interrupted();
      progress.at(static_cast<double>(i) / static_cast<double>(r.size()));
    }
    for (int piece = 0; piece < pieces; ++piece) {
      stepper.step(state, {{held + between(f[i - 1], f[i], piece, pieces),
                            held + between(f[i - 1], f[i], piece + 1, pieces)}});
      const bool inside = piece + 1 < pieces && (piece + 1) % parts == 0;
      if (inside)
        held = pid.update(between(r.u[i - 1], r.u[i], piece + 1, pieces) - output(plant, 0.0, state.data()));
    }
    const double y = output(plant, 0.0, state.data());
    // The record ends before the edge on its last sample.
    if (i % interval == 0 && i + 1 < r.size()) held = pid.update(r.u[i] - y);
    out.y.push_back(y);
    out.drive.push_back(f[i] + held);
  }
  out.stats.steps = (r.size() - 1) * static_cast<std::size_t>(pieces);
}

/// How the controller's samples lie on the record's.
struct SampleTimes {
  int edges = 1;             ///< clock edges a sample interval, or
  std::size_t interval = 1;  ///< one in so many samples
};

/// Nothing when they have no common grid.
std::optional<SampleTimes> sample_times(double period_s, double step_s) {
  const double ratio = period_s / step_s;
  const double times = std::max(ratio, 1.0 / ratio);
  const double whole = std::round(times);
  if (std::abs(times - whole) > 1e-9 * whole || whole > 1e6) return std::nullopt;
  if (ratio >= 1.0) return SampleTimes{1, static_cast<std::size_t>(whole)};
  return SampleTimes{static_cast<int>(whole), 1};
}

/// The plant as one linear system; `approximation_error` of its blocks added up.
std::variant<LinearKernel, NoClosedForm> linear_plant(const chain::Chain& plant) {
  LinearKernel out = chain::gain_kernel(1.0);
  for (std::size_t i = 0; i < plant.blocks.size(); ++i) {
    const chain::Kernel kernel = plant.blocks[i].kernel();
    const auto* k = std::get_if<LinearKernel>(&kernel);
    if (k == nullptr || k->delay_s > 0.0) {
      return NoClosedForm{
          fmt::format("block {} ({}) is not linear dynamics", i + 1, plant.blocks[i].type_name())};
    }
    out = chain::in_series(out, *k);
  }
  if (out.d != 0.0 || out.order() == 0) return NoClosedForm{"the plant answers its drive at once"};
  return out;
}

LoopOutcome run_exact_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                           const PidController& controller, const TimeRecord& reference, Start start,
                           int parts) {
  const auto made = linear_plant(plant);
  if (const auto* none = std::get_if<NoClosedForm>(&made)) return *none;
  const LinearKernel& linear = std::get<LinearKernel>(made);
  const bool sampled = controller.period_s > 0.0;
  const auto times = sampled ? sample_times(controller.period_s, reference.step_s) : SampleTimes{};
  if (!times) {
    return NoClosedForm{
        "the controller's period and the record's step are not whole multiples of each other"};
  }
  if (!sampled && controller.limited()) {
    return NoClosedForm{"a continuous controller with limits is not linear"};
  }
  LoopResult out;
  out.stats.engine = Engine::exact;
  out.model_error = linear.approximation_error;
  std::vector<double> state(linear.order(), 0.0);
  if (start == Start::equilibrium) equilibrium(linear, feedforward.front(), state.data());
  out.y.reserve(reference.size());
  out.drive.reserve(reference.size());
  if (sampled) {
    run_sampled_controller(linear, feedforward, controller, reference, times->edges, times->interval, parts,
                           std::move(state), out);
  } else {
    run_continuous(linear, feedforward, controller, reference, parts, std::move(state), out);
  }
  return out;
}

/// Delays as all-passes of order 6, the diagonal Padé approximants: within 0.11 degrees where f T is at most 1, which is
/// above any crossover at which a loop with that delay is stable.
chain::Chain with_rational_delays(const chain::Chain& plant, std::vector<std::string>& notes) {
  constexpr int kOrder = 6;
  constexpr double kGoodTo = 1.0;
  chain::Chain out = plant;
  out.blocks.clear();
  for (const chain::Block& block : plant.blocks) {
    const Kernel kernel = block.kernel();
    const auto* linear = std::get_if<LinearKernel>(&kernel);
    if (linear == nullptr || !(linear->delay_s > 0.0) || linear->order() > 0) {
      out.blocks.push_back(block);
      continue;
    }
    const chain::Chain allpass = chain::chain_of(filters::delay_allpass(linear->delay_s, kOrder));
    out.blocks.insert(out.blocks.end(), allpass.blocks.begin(), allpass.blocks.end());
    notes.push_back(
        fmt::format("the delay of {} stands in the loop as an all-pass of order {}, the same up to {}",
                    engineering_text(linear->delay_s, "s"), kOrder,
                    engineering_text(kGoodTo / linear->delay_s, "Hz", 2)));
  }
  return out;
}

/// The plant's kernels, each of which can stand in an ODE. DesignError names one that cannot.
std::vector<Kernel> plant_kernels(const chain::Chain& plant) {
  std::vector<Kernel> out;
  for (std::size_t i = 0; i < plant.blocks.size(); ++i) {
    out.push_back(plant.blocks[i].kernel());
    if (!can_stand_in_ode(out.back())) {
      throw DesignError(fmt::format(
          "block {} ({}) of the plant cannot stand inside a feedback loop, expected dynamics, curves or "
          "rate-independent memory",
          i + 1, plant.blocks[i].type_name()));
    }
  }
  return out;
}

LoopResult run_in_cvode(const chain::Chain& plant, const TimeRecord& forward, const PidController& controller,
                        const TimeRecord& reference, const Options& options) {
  LoopResult out;
  out.stats.engine = Engine::cvode;
  constexpr double kMostRestarts = 5e6;  // CVODE starts again at every one
  if (controller.period_s > 0.0)
    require_few_edges(reference.duration_s() / controller.period_s, "the controller's clock", kMostRestarts);
  std::vector<Kernel> kernels = plant_kernels(plant);
  // A part at the front passes the drive on unchanged, so that it is seen even without blocks.
  Kernel front = chain::gain_kernel(1.0);
  std::vector<Kernel*> pointers = {&front};
  for (Kernel& kernel : kernels) {
    if (const auto* linear = std::get_if<LinearKernel>(&kernel))
      out.model_error += linear->approximation_error;
    pointers.push_back(&kernel);
  }
  const DenseSignal input = DenseSignal::from_record(forward);
  const DenseSignal dense_reference = DenseSignal::from_record(reference);
  OdeSystem system(pointers, input);
  system.start(start_of(plant, options.start), forward.u.front());
  if (system.close_loop(controller, dense_reference) == OdeSystem::LoopOutcome::algebraic) {
    throw DesignError(
        "the plant answers its drive at once, expected a strictly proper block in it (an amplifier's "
        "lowpass, a resonator) with no memory after it");
  }
  OdeRequest request;
  request.right_limits = controller.period_s > 0.0;
  request.times = reference.times_s();
  request.values = &out.y;
  request.drive = &out.drive;
  solve_ode(system, options, request, out.stats, reference.step_s);
  return out;
}

LoopOutcome run_exact(const chain::Chain& plant, const std::vector<double>& feedforward,
                      const PidController& controller, const TimeRecord& reference, const Options& options) {
  const Stopwatch watch;
  LoopOutcome outcome =
      run_exact_loop(plant, feedforward, controller, reference, start_of(plant, options.start), 1);
  auto* out = std::get_if<LoopResult>(&outcome);
  if (out == nullptr) return outcome;
  out->stats.compute_s = watch.seconds();
  if (options.estimate_error) {
    const LoopOutcome again =
        run_exact_loop(plant, feedforward, controller, reference, start_of(plant, options.start), 2);
    out->error_estimate = error_figures(out->y, std::get<LoopResult>(again).y).max;
  }
  return outcome;
}

LoopResult run_cvode(const chain::Chain& plant, const std::vector<double>& feedforward,
                     const PidController& controller, const TimeRecord& reference, const Options& options) {
  const Stopwatch watch;
  TimeRecord forward = reference;
  forward.y.clear();
  forward.u = feedforward;
  try {
    LoopResult out = run_in_cvode(plant, forward, controller, reference, options);
    out.stats.compute_s = watch.seconds();
    if (options.estimate_error) {
      const LoopResult again = run_in_cvode(plant, forward, controller, reference, options.finer());
      out.error_estimate = error_figures(out.y, again.y).max;
    }
    return out;
  } catch (const SolverFailure& failure) {
    throw InputError(
        fmt::format("the loop cannot be solved: {} (an unstable loop? or a block that jumps when its input "
                    "turns, which only a sampled controller can drive)",
                    failure.what()));
  }
}

void validate_loop(const std::vector<double>& feedforward, const PidController& controller,
                   const TimeRecord& reference, const Options& options) {
  if (reference.size() < 2) throw InputError("the reference has fewer than two samples");
  if (feedforward.size() != reference.size()) {
    throw InputError(fmt::format("the feed-forward signal has {} samples, expected the reference's {}",
                                 feedforward.size(), reference.size()));
  }
  if (!(controller.derivative_corner.value > 0.0) || controller.period_s < 0.0 ||
      !(controller.lower < controller.upper)) {
    throw InputError("the controller's derivative corner, period or limits are out of range");
  }
  if (controller.period_s > 0.0)
    require_few_edges(reference.duration_s() / controller.period_s,
                      fmt::format("a controller that samples every {} s", rounded_text(controller.period_s)));
  if (options.engine == Engine::record) {
    throw InputError("a loop cannot be worked out block by block, expected the engine exact or cvode");
  }
}

/// In closed form where there is one and it is not forbidden, else in CVODE where that is allowed.
LoopResult run_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                    const PidController& controller, const TimeRecord& reference, const Options& options) {
  if (options.engine == Engine::cvode) return run_cvode(plant, feedforward, controller, reference, options);
  LoopOutcome exact = run_exact(plant, feedforward, controller, reference, options);
  if (auto* out = std::get_if<LoopResult>(&exact)) return std::move(*out);
  if (options.engine == Engine::exact)
    throw InputError("the loop has no closed form: " + std::get<NoClosedForm>(exact).text);
  return run_cvode(plant, feedforward, controller, reference, options);
}

}  // namespace

LoopResult simulate_loop(const chain::Chain& plant, const std::optional<chain::Chain>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options) {
  if (!feedforward) {
    return simulate_loop(plant, std::vector<double>(reference.size(), 0.0), controller, reference, options);
  }
  Options once = options;
  once.engine = Engine::automatic;
  return simulate_loop(plant, simulate(*feedforward, reference, once).y, controller, reference, options);
}

LoopResult simulate_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options) {
  validate_loop(feedforward, controller, reference, options);
  std::vector<std::string> notes;
  LoopResult out = run_loop(with_rational_delays(plant, notes), feedforward, controller, reference, options);
  out.notes = std::move(notes);
  for (const double y : out.y) {
    if (!(std::abs(y) <= kLargestOutput))
      throw RunsAway("the loop is unstable: its output grows without bound");
  }
  return out;
}

}  // namespace bodesmith::simulate
