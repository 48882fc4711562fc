#include "simulate/ode/ode_system.hpp"

#include <algorithm>
#include <limits>

namespace bodesmith::simulate {

OdeSystem::OdeSystem(const std::vector<chain::Kernel*>& kernels, const DenseSignal& input)
    : input_(input), reader_(input) {
  for (const chain::Kernel* kernel : kernels) {
    const Placed& placed = parts_.emplace_back(Placed{make_ode_part(*kernel), order_, events_});
    order_ += placed->order();
    events_ += placed->events();
    if (placed->needs_slopes()) usual_walk_ = Walk::slopes;
  }
  state_.assign(std::max<std::size_t>(order_, 1), 0.0);
  rates_ = state_;
}

double OdeSystem::start(Start how, double rest) {
  const bool still = how == Start::equilibrium;
  // The chain's value at the first sample, block by block; at rest under it for an equilibrium.
  double u = still ? rest : reader_.value(input_.begin());
  for (Placed& placed : parts_) u = placed->start(input_.begin(), u, still, state_.data() + placed.state);
  return u;
}

OdeSystem::LoopOutcome OdeSystem::close_loop(const PidController& controller, const DenseSignal& reference) {
  std::size_t behind = parts_.size();
  while (behind > 0 && !parts_[behind - 1]->strictly_proper()) --behind;
  if (behind == 0) return LoopOutcome::algebraic;
  for (std::size_t i = behind; i < parts_.size(); ++i) {
    if (!parts_[i]->output(0.0, 0.0, state_.data() + parts_[i].state)) return LoopOutcome::algebraic;
  }
  loop_.emplace(Loop{controller, DenseSignal::Reader(reference), reference.corners(), behind - 1,
                     SampledPid(controller)});
  state_.resize(order_ + kPidStates, 0.0);
  rates_ = state_;
  ahead_.resize(order_);
  return LoopOutcome::closed;
}

std::vector<double> OdeSystem::corners() const {
  std::vector<double> out = input_.corners();
  if (loop_) out.insert(out.end(), loop_->corners.begin(), loop_->corners.end());
  return out;
}

double OdeSystem::fastest_rate() const {
  // What keeps an integral from a limit is as stiff as it is narrow.
  const bool limited = loop_ && loop_->controller.period_s == 0.0 && loop_->controller.limited();
  double out = limited ? std::numeric_limits<double>::infinity() : 0.0;
  for (const Placed& placed : parts_) out = std::max(out, placed->fastest_rate());
  return out;
}

double OdeSystem::output_of_states(double t, const double* x) const {
  double u = 0.0;
  for (std::size_t i = loop_->proper; i < parts_.size(); ++i)
    u = *parts_[i]->output(t, u, x + parts_[i].state);
  return u;
}

void OdeSystem::sample_controller(double t) {
  loop_->held = loop_->sampled.update(loop_->reference.value(t) - output_of_states(t, state_.data()));
}

double OdeSystem::control_slope(double t, bool left, const double* x, double* dx, Walk usual) {
  // The slope of the error needs the rates of the states, which need no slopes: once through without. `dx`
  // holds the controller's rates already.
  walk(t, {reader_.value(t, left) + loop_->held, 0.0}, x, dx, usual);
  constexpr double kStep = 1e-7;
  for (std::size_t i = 0; i < order_; ++i) ahead_[i] = x[i] + kStep * dx[i];
  const double y_slope = (output_of_states(t + kStep, ahead_.data()) - output_of_states(t, x)) / kStep;
  return continuous_control_slope(loop_->controller, loop_->reference.slope(t, left) - y_slope, dx + order_);
}

double OdeSystem::evaluate(double t, const double* x, double* dx, Walk purpose) {
  const bool left = t >= end_;
  SlopedValue in{reader_.value(t, left), purpose == Walk::rates ? 0.0 : reader_.slope(t, left)};
  if (order_ == 0) dx[0] = 0.0;
  if (!loop_) return walk(t, in, x, dx, purpose);
  if (loop_->controller.period_s > 0.0) {
    std::fill_n(dx + order_, kPidStates, 0.0);
    in.value += loop_->held;
    return walk(t, in, x, dx, purpose);
  }
  const double error = loop_->reference.value(t, left) - output_of_states(t, x);
  loop_->held = continuous_control(loop_->controller, error, x + order_, dx + order_);
  if (purpose != Walk::rates) in.slope += control_slope(t, left, x, dx, usual_walk_);
  in.value += loop_->held;
  return walk(t, in, x, dx, purpose);
}

double OdeSystem::evaluate(double t, const double* x, double* dx) {
  return evaluate(t, x, dx, usual_walk_);
}

double OdeSystem::walk(double t, SlopedValue in, const double* x, double* dx, Walk purpose) {
  for (Placed& placed : parts_) in = placed->walk(t, in, x + placed.state, dx + placed.state, purpose);
  return in.value;
}

void OdeSystem::newton(double t, const double* x, double gamma, double* b) {
  evaluate(t, x, rates_.data());
  double du = 0.0;
  for (Placed& placed : parts_) du = placed->newton(gamma, du, x + placed.state, b + placed.state);
}

void OdeSystem::event_values(double t, const double* x, double* g) {
  evaluate(t, x, rates_.data());
  for (const Placed& placed : parts_) placed->event_values(x + placed.state, g + placed.event);
}

void OdeSystem::commit() {
  for (Placed& placed : parts_) placed->commit();
}

void OdeSystem::restart(double t, const std::vector<int>* crossings) {
  const auto own = [&](const Placed& placed) {
    return crossings == nullptr ? nullptr : crossings->data() + placed.event;
  };
  for (Placed& placed : parts_) placed->cross(own(placed), state_.data() + placed.state);
  evaluate(t, state_.data(), rates_.data(), Walk::restart);
}

}  // namespace bodesmith::simulate
