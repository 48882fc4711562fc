#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "base/units.hpp"
#include "lti/state_space.hpp"

namespace bodesmith::chain {

/// What an engine (simulate/) runs: a block with its parameters turned into numbers. A block type picks one
/// of these kinds; the engines know the kinds, never the blocks.

/// A state space, its output then delayed by delay_s. All eigenvalues of A have Re < 0.
struct LinearKernel : StateSpace {
  double delay_s = 0.0;
  /// Not 0 when the linear system is itself an approximation (a fractional term): a bound on
  /// |H_this/H_exact - 1| over all frequencies.
  double approximation_error = 0.0;

  bool operator==(const LinearKernel&) const = default;
};

/// c0 + c1 u + c2 u^2 + ...
inline double polynomial_at(const std::vector<double>& c, double u) {
  double sum = 0.0;
  for (std::size_t k = c.size(); k-- > 0;) sum = sum * u + c[k];
  return sum;
}

/// y = f(u), no memory.
class CurveKernel {
 public:
  virtual ~CurveKernel() = default;
  virtual double value(double u) const = 0;
  virtual double slope(double u) const = 0;
  /// Inputs where f or f' is not continuous, for engines that stop there.
  virtual std::vector<double> corners() const { return {}; }
  /// Coefficients [c0, c1, ...] when f is a polynomial everywhere, otherwise null.
  virtual const std::vector<double>* polynomial() const { return nullptr; }
  /// The input that the curve turns into y at rest is not needed; f may be applied to whole arrays.
  virtual void values(const double* u, double* y, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) y[i] = value(u[i]);
  }
};

/// y = u + a(t), t in seconds as in the record.
class SourceKernel {
 public:
  virtual ~SourceKernel() = default;
  virtual double value(double t) const = 0;
  virtual double rate(double t) const = 0;
  /// True when a(t) is a straight line.
  virtual bool straight() const { return false; }
};

/// Smooth nonlinear dynamics, x' = A x + b u + constant + e n(x, u),  y = c x + d u + offset, all but e and n
/// in `linear()`.
class OdeKernel {
 public:
  virtual ~OdeKernel() = default;
  virtual const StateSpace& linear() const = 0;
  virtual const std::vector<double>& entry() const = 0;  ///< e
  virtual double nonlinear(const double* x, double u) const = 0;
  /// dn/dx into `by_x`; returns dn/du.
  virtual double nonlinear_gradient(const double* x, double u, double* by_x) const = 0;
  /// The state at rest under the constant input u.
  virtual void equilibrium(double u, double* x) const = 0;
};

/// An operator with memory, driven along a piecewise monotone input. step() and peek() allocate nothing.
class MemoryKernel {
 public:
  virtual ~MemoryKernel() = default;
  /// Forgets everything. `equilibrium`: rests under u; otherwise rests under 0 and then jumps to u. Returns
  /// the output there.
  virtual double reset(double u, bool equilibrium) = 0;
  /// The input moves along a straight line from where it was to u within dt_s; returns the output at its end.
  virtual double step(double u, double dt_s) = 0;
  virtual double peek(double u, double dt_s) const = 0;
  /// False: the output depends on how fast the input moves.
  virtual bool rate_independent() const = 0;
  /// Above 0: the operator is x following u at no more than this rate, which engines may work out by events, and
  /// y = x + slew_feedthrough() (u - x).
  virtual double slew_rate() const { return 0.0; }
  virtual double slew_feedthrough() const { return 0.0; }
  /// Inputs at which the output jumps, for engines that stop there.
  virtual std::vector<double> corners() const { return {}; }
  /// Whether y is one curve of u while the input rises (also before it first moves) and another while it falls, whatever came
  /// before; switch_delay_s() later, to be exact.
  virtual bool has_branches() const { return false; }
  virtual double on_branch(bool /*rising*/, double u) const { return u; }
  /// Of operators with branches: the branch follows the input's direction this much later.
  virtual double switch_delay_s() const { return 0.0; }
  /// Not empty: the branch is this polynomial [c0, c1, ...] of u.
  virtual std::vector<double> branch_polynomial(bool /*rising*/) const { return {}; }
};

/// Works on samples taken at t = first_edge + k/clock_hz; its output is held from `delay_s` after each sample
/// until the next one. First edge at the first sample of the record.
class SampledKernel {
 public:
  virtual ~SampledKernel() = default;
  virtual double clock_hz() const = 0;
  virtual double delay_s() const = 0;
  /// Rests at zero, or under the constant input u; returns the output held before the first edge.
  virtual double reset(double u, bool equilibrium) = 0;
  virtual double update(double sample) = 0;
};

using Kernel =
    std::variant<LinearKernel, std::unique_ptr<CurveKernel>, std::unique_ptr<SourceKernel>,
                 std::unique_ptr<OdeKernel>, std::unique_ptr<MemoryKernel>, std::unique_ptr<SampledKernel>>;

/// y = gain u + offset.
LinearKernel gain_kernel(double gain, double offset = 0.0);
/// gain (1 + s/zero)/(1 + s/pole), rad/s; zero = infinity: gain/(1 + s/pole).
LinearKernel pole_zero_kernel(double gain, double zero_rad_s, double pole_rad_s);
/// `first` feeding `second`: states of the first, then of the second; delays add (the first one's delay then
/// also holds back the second one's offset: engines that care keep those apart).
LinearKernel in_series(const LinearKernel& first, const LinearKernel& second);

/// The slower time constant of the poles of 1 + 2 zeta s/w + s^2/w^2, w = 2 pi f.
double mode_time_constant_s(Hertz natural_frequency, double damping_ratio);

/// H(s) of the kernel as it is, delay included, offset left out.
Complex response(const LinearKernel& kernel, Complex s);

}  // namespace bodesmith::chain
