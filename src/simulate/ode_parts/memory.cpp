// An operator with rate-independent memory: between restarts its input moves one way, and the output is what
// the operator would show there. Events: the operator's corners, and the slope of its input, whose zero is a
// turn.
#include <algorithm>
#include <cmath>

#include "simulate/ode_parts/direction.hpp"
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

class MemoryPart final : public OdePart {
 public:
  explicit MemoryPart(chain::MemoryKernel& memory) : memory_(memory), corners_(memory.corners()) {}

  std::size_t events() const override { return corners_.size() + 1; }
  bool needs_slopes() const override { return true; }

  double start(double /*t*/, double u, bool still, double* /*x*/) override {
    in_.value = u;
    return memory_.reset(u, still);
  }
  double newton(double /*gamma*/, double du, const double* /*x*/, double* /*z*/) override {
    return du * slope();
  }
  void event_values(const double* /*x*/, double* g) const override {
    for (std::size_t i = 0; i < corners_.size(); ++i) g[i] = in_.value - corners_[i];
    g[corners_.size()] = direction_.event(in_.slope);
  }
  void commit() override {
    memory_.step(in_.value, 0.0);
    direction_.passed(in_.slope);
  }
  void cross(const int* crossings, double* /*x*/) override {
    const int turned = crossings == nullptr ? 0 : crossings[corners_.size()];
    if (turned != 0) direction_.rising = turned > 0;
  }

 private:
  /// Of the output over the input, on its way.
  double slope() const {
    const double u = in_.value;
    const double step = std::copysign(1e-8 * std::max(std::abs(u), 1e-3), in_.slope);
    return (memory_.peek(u + step, 0.0) - memory_.peek(u, 0.0)) / step;
  }

  SlopedValue pass(double /*t*/, SlopedValue in, const double* /*x*/, double* /*dx*/, Walk purpose) override {
    if (purpose == Walk::restart) {
      memory_.step(in.value, 0.0);  // what stands in front may have jumped
      if (std::abs(in.slope) > direction_.rest()) direction_.rising = in.slope > 0.0;
    }
    return {memory_.peek(in.value, 0.0), in.slope != 0.0 ? in.slope * slope() : in.slope};
  }

  chain::MemoryKernel& memory_;
  std::vector<double> corners_;
  Direction direction_;  ///< of the input
};

}  // namespace

std::unique_ptr<OdePart> make_memory_part(chain::MemoryKernel& memory) {
  return std::make_unique<MemoryPart>(memory);
}

}  // namespace bodesmith::simulate
