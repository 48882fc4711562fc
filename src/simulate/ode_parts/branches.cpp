// y = f(u), f one of two curves by the direction of u some time earlier (MemoryKernel::has_branches). Events: the slope of
// the input, whose zero is a turn, and the switch that follows it.
#include <algorithm>
#include <cmath>
#include <deque>

#include "simulate/ode_parts/direction.hpp"
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

class BranchPart final : public OdePart {
 public:
  explicit BranchPart(const chain::MemoryKernel& memory) : memory_(memory) {}

  std::size_t events() const override { return 2; }
  bool needs_slopes() const override { return true; }

  double start(double t, double u, bool still, double* /*x*/) override {
    now_ = t;
    committed_ = still ? u : 0.0;
    in_.value = u;
    commit();
    switch_over();
    return memory_.on_branch(branch_, u);
  }
  double newton(double /*gamma*/, double du, const double* /*x*/, double* /*z*/) override {
    return du * slope_at(in_.value);
  }
  void event_values(const double* /*x*/, double* g) const override {
    g[0] = direction_.event(in_.slope);
    g[1] = due_.empty() ? 1.0 : due_.front() - now_;
  }
  void commit() override {
    move_to(in_.value);
    direction_.passed(in_.slope);
  }
  void cross(const int* crossings, double* /*x*/) override {
    // A turn found by its event keeps the direction found: its slope is about 0.
    turned_ = crossings != nullptr && crossings[0] != 0;
    if (turned_) turn(crossings[0] > 0);
    if (crossings != nullptr && crossings[1] != 0) due_.front() = now_;
    switch_over();
  }

 private:
  /// A jump is a move too.
  void move_to(double u) {
    constexpr double kSmallest = 1e-12;  // share of the signal below which a move is rounding
    const double move = u - committed_;
    if (std::abs(move) > kSmallest * std::max(std::abs(u), std::abs(committed_))) turn(move > 0.0);
    committed_ = u;
  }
  void turn(bool rising) {
    if (rising != direction_.rising) due_.push_back(now_ + memory_.switch_delay_s());
    direction_.rising = rising;
  }
  void switch_over() {
    for (; !due_.empty() && due_.front() <= now_; due_.pop_front()) branch_ = !branch_;
  }
  double slope_at(double u) const {
    const double step = 1e-6 * std::max(std::abs(u), 1e-3);
    return (memory_.on_branch(branch_, u + step) - memory_.on_branch(branch_, u - step)) / (2.0 * step);
  }
  SlopedValue pass(double t, SlopedValue in, const double* /*x*/, double* /*dx*/, Walk purpose) override {
    now_ = t;
    if (purpose == Walk::restart) {
      move_to(in.value);
      if (!turned_ && std::abs(in.slope) > direction_.rest()) turn(in.slope > 0.0);
      switch_over();
    }
    return {memory_.on_branch(branch_, in.value), in.slope != 0.0 ? in.slope * slope_at(in.value) : in.slope};
  }

  const chain::MemoryKernel& memory_;
  double now_ = 0.0;
  Direction direction_;     ///< of the input
  bool branch_ = true;      ///< what the switch stands at
  bool turned_ = false;     ///< at the restart
  double committed_ = 0.0;  ///< where the input stood
  std::deque<double> due_;  ///< times at which the switch will toggle
};

}  // namespace

std::unique_ptr<OdePart> make_branch_part(const chain::MemoryKernel& memory) {
  return std::make_unique<BranchPart>(memory);
}

}  // namespace bodesmith::simulate
