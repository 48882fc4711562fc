// x follows u at no more than a given rate, and y = x + c (u - x): one state, with an event where the limit sets in (the
// input becomes too fast) or ends (the state has caught up).
#include <algorithm>
#include <cmath>

#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

class SlewPart final : public OdePart {
 public:
  explicit SlewPart(const chain::MemoryKernel& memory)
      : corners_(memory.corners()), rate_(memory.slew_rate()), feedthrough_(memory.slew_feedthrough()) {}

  std::size_t order() const override { return 1; }
  std::size_t events() const override { return corners_.size() + 1; }
  bool needs_slopes() const override { return true; }

  double start(double /*t*/, double u, bool still, double* x) override {
    in_.value = u;
    x[0] = still ? u : 0.0;
    if (x[0] != u) mode_ = towards(u - x[0]);
    return with_feedthrough(u, x[0]);
  }
  double newton(double /*gamma*/, double du, const double* /*x*/, double* z) override {
    // Following, the state only shadows the input: Newton may take its rate as given.
    return mode_ == Mode::following ? du : with_feedthrough(du, z[0]);
  }
  void event_values(const double* x, double* g) const override {
    for (std::size_t i = 0; i < corners_.size(); ++i) g[i] = in_.value - corners_[i];
    g[corners_.size()] =
        mode_ == Mode::following ? (rate_ - in_.slope) * (rate_ + in_.slope) : x[0] - in_.value;
  }
  void cross(const int* crossings, double* x) override {
    const bool crossed = crossings != nullptr && crossings[corners_.size()] != 0;
    if (mode_ == Mode::following) {
      x[0] = in_.value;
      if (crossed) mode_ = towards(in_.slope);  // the input has just become too fast
    } else if (crossed) {
      x[0] = in_.value;
      mode_ = Mode::following;
    }
  }

 private:
  enum class Mode { following, rising, falling };
  double with_feedthrough(double u, double x) const { return x + feedthrough_ * (u - x); }
  static Mode towards(double difference) { return difference > 0.0 ? Mode::rising : Mode::falling; }

  SlopedValue pass(double /*t*/, SlopedValue in, const double* x, double* dx, Walk purpose) override {
    if (purpose == Walk::restart) {
      // A jump of the input leaves the output behind, on either side.
      const double gap = in.value - x[0];
      if (std::abs(gap) > 1e-9 * std::max(std::abs(x[0]), std::abs(in.value))) mode_ = towards(gap);
      if (mode_ == Mode::following && std::abs(in.slope) > rate_) mode_ = towards(in.slope);
    }
    if (mode_ == Mode::following) {
      dx[0] = in.slope;
      return in;
    }
    dx[0] = mode_ == Mode::rising ? rate_ : -rate_;
    return {with_feedthrough(in.value, x[0]), with_feedthrough(in.slope, dx[0])};
  }

  std::vector<double> corners_;
  double rate_, feedthrough_;
  Mode mode_ = Mode::following;
};

}  // namespace

std::unique_ptr<OdePart> make_slew_part(chain::MemoryKernel& memory) {
  return std::make_unique<SlewPart>(memory);
}

}  // namespace bodesmith::simulate
