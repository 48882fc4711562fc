// An operator with rate-independent memory: between restarts its input moves one way, and the output is what
// the operator would show there. Events: the operator's corners, and the slope of its input, whose zero is a
// turn.
#include <algorithm>
#include <cmath>

#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

/// Moves below this share of the signal are rounding, not a turn.
constexpr double kSmallestMove = 1e-12;

class MemoryPart final : public OdePart {
 public:
  explicit MemoryPart(chain::MemoryKernel& memory) : memory_(memory), corners_(memory.corners()) {}

  std::size_t events() const override { return corners_.size() + 1; }
  bool needs_slopes() const override { return true; }
  bool output_follows() const override { return false; }

  double start(double /*t*/, double u, bool still, double* /*x*/) override {
    committed_ = in_.value = u;
    direction_ = u < 0.0 ? -1 : 1;
    return memory_.reset(u, still);
  }
  double output(double /*t*/, double u, const double* /*x*/) const override {
    // A hair on the wrong side of the last turn is rounding, not another turn.
    const bool moved = (u - committed_) * direction_ > 0.0;
    return moved ? memory_.peek(u, 0.0) : memory_.departing(committed_ + direction_);
  }
  double newton(double /*gamma*/, double du, const double* /*x*/, double* /*z*/) override {
    return du * slope_at(in_.value);
  }
  void event_values(const double* /*x*/, double* g) const override {
    for (std::size_t i = 0; i < corners_.size(); ++i) g[i] = in_.value - corners_[i];
    g[corners_.size()] = in_.slope;
  }
  void commit() override {
    // A jump is a move too, whose direction the branch behind it has.
    if ((in_.value - committed_) * direction_ < -kSmallestMove * std::abs(in_.value)) direction_ = -direction_;
    memory_.step(in_.value, 0.0);
    committed_ = in_.value;
  }
  void cross(const int* crossings, double* /*x*/) override {
    if (turned(crossings) != 0) direction_ = turned(crossings);
    found_direction_ = direction_;
  }
  bool set_right(const int* crossings) override {
    // A turn found by its event keeps the direction found: its slope is about 0.
    if (turned(crossings) == 0) return false;
    const bool changed = direction_ != found_direction_;
    direction_ = found_direction_;
    return changed;
  }

 private:
  int turned(const int* crossings) const { return crossings == nullptr ? 0 : crossings[corners_.size()]; }

  double slope_at(double u) const {
    const double step = 1e-6 * std::max(std::abs(u), 1e-3) * direction_;
    return (memory_.peek(u + step, 0.0) - memory_.peek(u, 0.0)) / step;
  }

  SlopedValue pass(double t, SlopedValue in, const double* x, double* /*dx*/, Walk purpose) override {
    if (purpose == Walk::restart && in.slope != 0.0) direction_ = in.slope > 0.0 ? 1 : -1;
    const double y = output(t, in.value, x);
    return {y, in.slope != 0.0 ? in.slope * slope_at(in.value) : in.slope};
  }

  chain::MemoryKernel& memory_;
  std::vector<double> corners_;
  int direction_ = 1;  ///< of the input
  int found_direction_ = 1;
  double committed_ = 0.0;  ///< where the operator's own input stands
};

}  // namespace

std::unique_ptr<OdePart> make_memory_part(chain::MemoryKernel& memory) {
  return std::make_unique<MemoryPart>(memory);
}

}  // namespace bodesmith::simulate
