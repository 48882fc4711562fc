// y = f(u), f one of two curves by the direction of u some time earlier (MemoryKernel::has_branches). Events: the slope of
// the input, whose zero is a turn, and the switch that follows it.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

class BranchPart final : public OdePart {
 public:
  explicit BranchPart(const chain::MemoryKernel& memory) : memory_(memory) {}

  std::size_t events() const override { return 2; }
  bool needs_slopes() const override { return true; }
  bool output_follows() const override { return false; }

  double start(double t, double u, bool still, double* /*x*/) override {
    now_ = t;
    committed_ = still ? u : 0.0;
    in_.value = u;
    commit();
    switch_over();
    return memory_.on_branch(branch_, u);
  }
  double output(double /*t*/, double u, const double* /*x*/) const override {
    return memory_.on_branch(branch_, u);
  }
  double newton(double /*gamma*/, double du, const double* /*x*/, double* /*z*/) override {
    return du * slope_at(in_.value);
  }
  void event_values(const double* /*x*/, double* g) const override {
    g[0] = in_.slope + (rising_ ? rest() : -rest());
    g[1] = due_.empty() ? 1.0 : due_.front() - now_;
  }
  void commit() override {
    // A jump is a move too; less than this share of the signal is rounding.
    constexpr double kSmallest = 1e-12;
    const double move = in_.value - committed_;
    if (std::abs(move) > kSmallest * std::max(std::abs(in_.value), std::abs(committed_))) turn(move > 0.0);
    committed_ = in_.value;
    fastest_ = std::max(fastest_, std::abs(in_.slope));
  }
  void cross(const int* crossings, double* /*x*/) override {
    // A turn found by its event keeps the direction found: its slope is about 0.
    turned_ = crossings != nullptr && crossings[0] != 0;
    if (turned_) turn(crossings[0] > 0);
    if (crossings != nullptr && crossings[1] != 0) due_.front() = now_;
    switch_over();
  }

 private:
  void turn(bool rising) {
    if (rising != rising_) due_.push_back(now_ + memory_.switch_delay_s());
    rising_ = rising;
  }
  void switch_over() {
    for (; !due_.empty() && due_.front() <= now_; due_.pop_front()) branch_ = !branch_;
  }
  /// Slower than this is rest, from which the input may move on either way.
  double rest() const {
    constexpr double kPart = 1e-9;
    return std::max(kPart * fastest_, std::numeric_limits<double>::min());
  }
  double slope_at(double u) const {
    const double step = 1e-6 * std::max(std::abs(u), 1e-3);
    return (memory_.on_branch(branch_, u + step) - memory_.on_branch(branch_, u - step)) / (2.0 * step);
  }
  SlopedValue pass(double t, SlopedValue in, const double* /*x*/, double* /*dx*/, Walk purpose) override {
    now_ = t;
    if (purpose == Walk::restart) {
      if (!turned_ && std::abs(in.slope) > rest()) turn(in.slope > 0.0);
      switch_over();
    }
    return {memory_.on_branch(branch_, in.value), in.slope != 0.0 ? in.slope * slope_at(in.value) : in.slope};
  }

  const chain::MemoryKernel& memory_;
  double now_ = 0.0;
  bool rising_ = true;      ///< direction of the input
  bool branch_ = true;      ///< what the switch stands at
  bool turned_ = false;     ///< at the restart
  double committed_ = 0.0;  ///< where the input stood
  double fastest_ = 0.0;    ///< its slope so far
  std::deque<double> due_;  ///< times at which the switch will toggle
};

}  // namespace

std::unique_ptr<OdePart> make_branch_part(const chain::MemoryKernel& memory) {
  return std::make_unique<BranchPart>(memory);
}

}  // namespace bodesmith::simulate
