#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "chain/kernel.hpp"
#include "simulate/dense_signal.hpp"
#include "simulate/pid.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {

/// Neighbouring blocks as one ODE x' = f(t, x) with events: linear and smooth nonlinear dynamics, curves,
/// sources, rate-independent memory, slew limits. Solved by CVODE, which starts again at every corner of the
/// input, where a curve has a corner, where the input of a memory turns, and where a slew limit sets in or
/// ends.
class OdeRun {
 public:
  OdeRun(std::vector<chain::Kernel*> kernels, const DenseSignal& input);

  /// `rest`: what the input rests at before the start (equilibrium); becomes that of the output.
  void start(Start how, double& rest);

  /// Closes a loop: the input of the first part becomes input + control(reference - output). The controller's
  /// integral and filter are two more states. False when no part is strictly proper.
  bool close_loop(const PidController& controller, const DenseSignal& reference);

  /// What is wanted of the output: values at these rising times, and/or a dense signal.
  struct Wanted {
    std::vector<double> times;
    bool right_limits = false;  ///< of the output at jumps
    std::vector<double>* values = nullptr;
    std::vector<double>* drive = nullptr;  ///< the input of the first part at the same times
    DenseSignal* dense = nullptr;
  };
  void solve(const Options& options, const Wanted& wanted, Stats& stats, double shortest_detail_s);

 private:
  enum class Follow { yes, up, down };
  struct Part {
    chain::Kernel* kernel = nullptr;
    int state = 0;
    int order = 0;
    int event = -1;  ///< first event function
    int events = 0;
    int direction = 1;  ///< of a memory's input
    double committed = 0.0;
    Follow follow = Follow::yes;
    std::vector<double> corners;
    int turn_event() const { return event + static_cast<int>(corners.size()); }
    // of the last Newton solve: I - gamma A, factorised (more than one state)
    double factored_gamma = 0.0;
    Eigen::PartialPivLU<Eigen::MatrixXd> factored;
    // of the last evaluation
    double u = 0.0;
    double du = 0.0;
    double y = 0.0;
  };

  void segment(double begin, double end);
  /// Walks the chain: inputs, outputs and slopes of every part, rates of all states; the output's value is
  /// last_.
  void evaluate(double t, const double* x, double* dx, bool restart);
  void walk(double t, double u, double du, const double* x, double* dx, bool restart);
  /// The chain's output from states alone, and its slope from their rates.
  double output_of(double t, const double* x) const;
  double control(double error, const double* pid, double* rates) const;
  void sample_controller(double t);
  void memory_output(Part& part, const chain::MemoryKernel& memory, double u) const;
  double memory_slope(const Part& part, const chain::MemoryKernel& memory, double u) const;
  /// Replaces b by (I - gamma df/dx)^-1 b. Blocks in series make df/dx block triangular, with full rows below
  /// the diagonal wherever a block passes its input on: not a band, but one walk along the chain solves it.
  void newton(double t, const double* x, double gamma, double* b);
  void events(double t, const double* x, double* g);
  /// Memories take the step to where their input now is.
  void commit();
  void restart_at(double t, const std::vector<int>* crossings);
  double stiffness() const;

  std::vector<Part> parts_;
  const DenseSignal& input_;
  DenseSignal::Reader reader_;
  double begin_ = 0.0;
  double end_ = 0.0;
  int order_ = 0;
  int events_ = 0;
  bool slopes_needed_ = false;
  std::vector<double> state_;
  std::vector<double> rates_;
  double last_ = 0.0;

  struct Loop {
    PidController controller;
    DenseSignal::Reader reference;
    std::vector<double> corners;  ///< of the reference
    std::size_t proper = 0;       ///< the last part without feedthrough
    SampledPid sampled;
    double held = 0.0;  ///< sampled: the control until the next sample
  };
  std::optional<Loop> loop_;
};

}  // namespace bodesmith::simulate
