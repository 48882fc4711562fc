#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "chain/kernel.hpp"
#include "simulate/ode_parts/ode_part.hpp"
#include "simulate/pid.hpp"
#include "simulate/record/dense_signal.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// Neighbouring blocks as one ODE x' = f(t, x) with events: linear and smooth nonlinear dynamics, curves,
/// sources, rate-independent memory, slew limits (ode_parts/). With a loop closed round them, the
/// controller's integral and filter are two more states. Solved by solve_ode() (ode_solve.hpp).
class OdeSystem {
 public:
  /// Kernels (each can_stand_in_ode()) and input outlive the system.
  OdeSystem(const std::vector<chain::Kernel*>& kernels, const DenseSignal& input);

  /// Sets the states at the first instant; `rest`: what the input rests at before it (equilibrium). Returns
  /// what the output rests at.
  double start(Start how, double rest);

  enum class LoopOutcome {
    closed,
    algebraic,  ///< no part is strictly proper, or a memory stands behind the last one that is
  };
  /// The input of the first part becomes input + control(reference - output).
  [[nodiscard]] LoopOutcome close_loop(const PidController& controller, const DenseSignal& reference);

  const DenseSignal& input() const { return input_; }
  bool has_dynamics() const { return order_ > 0; }
  std::size_t events() const { return events_; }
  bool in_loop() const { return loop_.has_value(); }
  /// Seconds between the samples of the controller; 0: continuous or no loop.
  double sample_period() const { return loop_ ? loop_->controller.period_s : 0.0; }
  /// Times at which the input, or the loop's reference, has a corner; unordered.
  std::vector<double> corners() const;
  /// Bound on the fastest rate of all parts, rad/s.
  double fastest_rate() const;

  /// All states; at least one, so that there is something to solve.
  std::vector<double>& state() { return state_; }
  const std::vector<double>& state() const { return state_; }

  /// Up to here the input counts from its left.
  void run_until(double end) { end_ = end; }
  /// Rates of all states; the output.
  double evaluate(double t, const double* x, double* dx);
  /// At state(), rates not wanted.
  double evaluate(double t) { return evaluate(t, state_.data(), rates_.data()); }
  /// The output alone.
  double output(double t, const double* x) { return evaluate(t, x, rates_.data()); }
  /// After an evaluation: the input of the first part.
  double drive() const { return parts_.front()->input(); }
  /// Replaces b by (I - gamma df/dx)^-1 b. Blocks in series make df/dx block triangular, with full rows below
  /// the diagonal wherever a block passes its input on: not a band, but one walk along the chain solves it.
  /// Not with a loop.
  void newton(double t, const double* x, double gamma, double* b);
  void event_values(double t, const double* x, double* g);
  /// After an evaluation: memories take the step to where their input now is.
  void commit();
  /// At a corner (no crossings) or an event: jumps are taken, directions and switches chosen anew.
  void restart(double t, const std::vector<int>* crossings);
  /// A clock edge of a sampled controller.
  void sample_controller(double t);

 private:
  struct Placed {
    std::unique_ptr<OdePart> part;
    std::size_t state = 0;  ///< its first state
    std::size_t event = 0;  ///< its first event function
    OdePart* operator->() const { return part.get(); }
  };
  struct Loop {
    PidController controller;
    DenseSignal::Reader reference;
    std::vector<double> corners;  ///< of the reference
    std::size_t proper = 0;       ///< the last part without feedthrough
    SampledPid sampled;
    double held = 0.0;  ///< sampled: the control until the next sample
  };

  double evaluate(double t, const double* x, double* dx, Walk purpose);
  /// Along the chain from the input of the first part; the output.
  double walk(double t, SlopedValue in, const double* x, double* dx, Walk purpose);
  /// With a loop: the chain's output from states alone.
  double output_of_states(double t, const double* x) const;
  /// The slope of the control, from the rates of the states.
  double control_slope(double t, bool left, const double* x, double* dx, Walk usual);

  std::vector<Placed> parts_;
  const DenseSignal& input_;
  DenseSignal::Reader reader_;
  Walk usual_walk_ = Walk::rates;
  double end_ = 0.0;
  std::size_t order_ = 0;  ///< without the controller
  std::size_t events_ = 0;
  std::vector<double> state_;
  std::vector<double> rates_;
  std::vector<double> ahead_;
  std::optional<Loop> loop_;
};

}  // namespace bodesmith::simulate
